"""From a model to a verdict: a wall at a site, in one sense, and how soil and method change it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import drystone as ds

MODEL = Path(__file__).with_name("wall_at_a_site.toml")


def main() -> dict[str, float | None]:
    """Trace the wall once, assess it several times; safety indices by what was assumed."""
    model = ds.read_model(MODEL)
    curve = ds.pushover(model)  # the site has no part in it

    verdict = curve.assess(model)
    print(verdict.sentence)
    for state in verdict.limit_states:
        print(f"  {state.name}: index {state.safety_index:.3f}, {state.governed_by}")
    indices: dict[str, float | None] = {"soil B": verdict.safety_index}

    assert model.site is not None
    soft = replace(model.site, values={**model.site.values, "soil": "D"})
    indices["soil D"] = curve.assess(model, site=soft).safety_index
    indices["rules of 2009"] = curve.assess(model, method="ntc2009-local").safety_index
    indices["by energy"] = curve.assess(model, reading="energy").safety_index
    indices["block by block"] = curve.assess(model, grouping="blocks").safety_index
    for name, index in indices.items():
        print(f"{name:>16}: safety index {index:.3f}")
    return indices


if __name__ == "__main__":
    main()
