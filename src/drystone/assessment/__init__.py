"""From a capacity curve to a decision: spectra, methods of the codes, verdicts."""
