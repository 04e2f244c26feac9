"""Files: models, drawings, results, and the formats of other programs."""
