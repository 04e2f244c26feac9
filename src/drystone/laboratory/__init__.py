"""Walls that were tested in laboratories: what was measured, their models, and both compared."""
