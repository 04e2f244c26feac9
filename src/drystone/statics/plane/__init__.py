"""Static steps of structures in the plane."""
