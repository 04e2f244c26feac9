"""Ties and forces that name no block: the one that holds their point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from drystone.geometry import GeometryError
from drystone.geometry.figure import Figure
from drystone.io.modelfile.schema import ModelSection
from drystone.io.modelfile.tying import EndSection, SpringSection
from drystone.model.assembly import Block
from drystone.model.construction.fit import turned_round
from drystone.model.construction.words import listed, millimetres, quoted
from drystone.model.ties import SAME

Bar = TypeVar("Bar", bound=SpringSection)


def with_holders(
    section: ModelSection, blocks: Sequence[Block], problems: list[str]
) -> ModelSection:
    """The tables of a file with the blocks named that hold the points of ties and forces which name
    none; what is wrong is added to ``problems``."""
    holders = _Holders(turned_round(blocks)[0])

    def end(own: EndSection, place: str) -> EndSection:
        if own.block is not None:
            return own
        return own.model_copy(update={"block": holders.named(own.point, place, problems)})

    def tied(own: Bar, kind: str, k: int) -> Bar:
        place = f'{kind} "{own.name}"' if own.name else f"{kind}[{k + 1}]"
        if own.from_.block is not None and own.to.block is not None:
            return own
        ends = {"from_": end(own.from_, f"{place}.from"), "to": end(own.to, f"{place}.to")}
        return own.model_copy(update=ends)

    def pushed(own: Any, place: str) -> Any:
        if own.block is not None or own.group is not None or not isinstance(own.point, list):
            return own
        name = holders.named(own.point, place, problems, movable=True)
        return own.model_copy(update={"block": name})

    load = section.load
    if load is not None:
        listed_ = {
            key: [pushed(one, f"load.{key}[{k + 1}]") for k, one in enumerate(getattr(load, key))]
            for key in load.model_fields_set
            if (tables := getattr(load, key)) and _are_at_points(tables)
        }
        load = load.model_copy(update=listed_)
    dead = [
        pushed(one, f"dead_load[{k + 1}]" + (f' "{one.name}"' if one.name else ""))
        for k, one in enumerate(section.dead_load)
    ]
    ties = [tied(one, "tie", k) for k, one in enumerate(section.tie)]
    springs = [tied(one, "spring", k) for k, one in enumerate(section.spring)]
    return section.model_copy(
        update={"load": load, "dead_load": dead, "tie": ties, "spring": springs}
    )


def _are_at_points(value: Any) -> bool:
    """Whether it is a list of tables that name a block or a group, and a point."""
    return isinstance(value, list) and all(
        {"block", "group", "point"} <= set(getattr(type(table), "model_fields", ()))
        for table in value
    )


@dataclass(eq=False)
class _Holders:
    """Blocks, and their figures once they are asked for."""

    blocks: Sequence[Block]
    figures: list[Figure | None] | None = None

    def named(
        self, point: Sequence[float], place: str, problems: list[str], *, movable: bool = False
    ) -> str:
        """The block that holds a point; "" where there is none or several, which is added to
        ``problems``."""
        if self.figures is None:
            self.figures = [_figure(block) for block in self.blocks]
        at = np.array(point, float)
        told = "(" + ", ".join(f"{x:g}" for x in point) + ")"
        away = {
            block.id: (figure.distance(at), SAME * float(np.ptp(block.vertices, axis=0).max()))
            for block, figure in zip(self.blocks, self.figures, strict=True)
            if figure is not None and len(at) == block.dimension
            if not (movable and block.support)
        }
        holding = [name for name, (distance, near) in away.items() if distance <= near]
        if len(holding) == 1:
            return holding[0]
        if holding:
            problems.append(
                f"{place}: {len(holding)} blocks hold the point {told}: name one of them as "
                f"block: {listed(holding)}"
            )
        elif away:
            nearest = min(away, key=lambda name: away[name][0])
            problems.append(
                f"{place}: no block holds the point {told}: move it, or name a block; nearest is "
                f"{quoted(nearest)}, {millimetres(away[nearest][0])} away"
            )
        else:
            problems.append(f"{place}: there is no block that could hold the point {told}")
        return ""


def _figure(block: Block) -> Figure | None:
    """What a block is; None where it is none, as is said where the model is put together."""
    try:
        return block.figure()
    except GeometryError:
        return None
