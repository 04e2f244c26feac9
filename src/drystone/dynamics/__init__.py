"""The engines `nscd`, `distinct` and `lmgc90`: steps and cycles in time."""
