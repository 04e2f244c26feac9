"""A model put together from its parts, and checked."""
