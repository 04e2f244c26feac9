"""What all rooms use: errors, names, records, ranges of numbers, threads, workers, compiled
code."""
