"""Outlines: polygons, their parts, and how drawn ones are mended."""
