"""Contacts: who touches whom, where, by which law, and how well a solution obeys it."""
