"""Solvers of the equations of a step: they see arrays, not models."""
