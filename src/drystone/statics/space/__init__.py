"""Static steps of structures in space."""
