"""Files that are changed at random, and what becomes of them: see ``tests/fuzz.py``."""
