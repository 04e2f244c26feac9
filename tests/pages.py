"""What a reader sees of a report: its words, those in pictures too."""

from __future__ import annotations

import base64
import re

_SVG = re.compile(r'<img alt="[^"]*" src="data:image/svg\+xml;base64,([^"]+)">')


def unfolded(page: str) -> str:
    """The page with the markup of its drawings in place of their data."""
    return _SVG.sub(lambda found: base64.b64decode(found[1]).decode("utf-8"), page)


def text_of(page: str) -> str:
    """All words, in one line."""
    page = re.sub(r"<(script|style|metadata)\b.*?</\1>", " ", unfolded(page), flags=re.S)
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))
