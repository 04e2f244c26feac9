"""What `drystone run --directions` says of all directions together."""

from __future__ import annotations

from pathlib import Path

import pytest
import synthetic

from drystone.cli.directions import report, write


def row(angle, multiplier=None, *, passed=True, capacity=None):
    """A direction as a worker returns it; without a multiplier one that has no point."""
    own = {"angle": angle, "direction": [1.0, 0.0], "folder": f"direction-{angle:03.0f}"}
    if multiplier is None:
        return {**own, "status": "interrupted", "reason": "interrupted before it began"}
    capacity = capacity or multiplier
    return {
        **own,
        "status": "finished" if passed else "interrupted",
        "reason": "",
        "peak_multiplier": multiplier,
        "peak_passed": passed,
        "capacity_multiplier": capacity,
        "capacity_displacement": 0.01,
        "ultimate_displacement": 0.1 if passed else None,
        "curve": [(0.0, 0.0), (0.01, capacity)],
    }


@pytest.mark.parametrize(
    ("rows", "least"),
    [
        ([row(0.0, 0.3), row(180.0, 0.2)], 0.2),
        # Of a curve that has not passed its peak, the multiplier so far is a lower bound.
        ([row(0.0, 0.3), row(180.0, 0.2, passed=False)], None),
        ([row(0.0, 0.2), row(180.0, 0.3, passed=False)], 0.2),
        ([row(0.0, 0.2), row(180.0)], None),
        ([row(0.0, 0.2, passed=False), row(180.0, 0.3, passed=False)], None),
        # What is left after a part has collapsed may rise on: the whole structure's is known.
        ([row(0.0, 0.3), row(180.0, 0.4, passed=False, capacity=0.1)], 0.1),
    ],
)
def test_the_least_capacity_is_said_where_it_is_known(tmp_path: Path, rows, least):
    summary = write(synthetic.wall_model(), rows, tmp_path)
    assert summary["least_capacity_multiplier"] == least
    said = report(summary, tmp_path)
    line = next(line for line in said.splitlines() if "least capacity" in line)
    assert (f"{least:.4f}" in line) if least else ("not known" in line)
