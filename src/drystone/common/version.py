"""The version of this package, as its installation knows it."""

from __future__ import annotations

from functools import cache


@cache
def package_version() -> str:
    """Version of this package; "unknown" where it runs without having been installed.

    Looked up once: that takes longer than a small analysis.
    """
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("drystone")
    except PackageNotFoundError:
        return "unknown"
