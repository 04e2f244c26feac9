"""Response spectra of the codes, from tables, and at a height above the ground."""
