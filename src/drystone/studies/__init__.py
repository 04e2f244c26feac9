"""Studies: many curves of one model with varied parameters, and what they say together."""
