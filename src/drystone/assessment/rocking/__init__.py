"""Rocking as motion: equivalent blocks, pulses, and time integration under a record."""
