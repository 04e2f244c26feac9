"""Solids: polyhedra, their parts, and how drawn ones are mended."""
