"""The engines `nscd` and `distinct`: steps and cycles in time."""
