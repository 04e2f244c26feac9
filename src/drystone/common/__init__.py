"""What all packages use: errors, names, records, ranges of numbers, threads, workers, compiled
code."""
