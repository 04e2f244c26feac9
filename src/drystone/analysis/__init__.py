"""One pushover analysis, several directions, the benchmark."""
