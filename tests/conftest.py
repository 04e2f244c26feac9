"""Settings of all tests.  This file's folder is where they import `builders` from."""

from hypothesis import settings

# A first call may compile for seconds; the examples are the same in every run.
settings.register_profile("drystone", deadline=None, derandomize=True)
settings.load_profile("drystone")
