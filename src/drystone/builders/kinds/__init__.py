"""Builders of structures: one file a kind, the table [[build]] of a model file calls them."""
