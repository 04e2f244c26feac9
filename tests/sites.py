"""The site of the worked examples of NTC 2018, soil B with S_S = 1.2, as tables of a model file."""

from __future__ import annotations

SITE = """
[site]
code = "ntc2018"
ag = 0.172
F0 = 2.458
TC_star = 0.285
soil = "B"
topography = "T1"
"""

#: With what a local mechanism is asked on it.
TABLES = f"""{SITE}
[assessment]
method = "ntc2018-local"
confidence_factor = 1.35
"""
