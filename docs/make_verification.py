"""Run the verification cases and write docs/reference/verification.md.

    python docs/make_verification.py [--engine NAME ...]

Every number on that page comes from here: ours from a run, the others from the source beside them.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import drystone as ds
from drystone.engines import engine_names
from drystone.engines.base import EngineError
from drystone.geometry.space import solid
from drystone.model.assembly import Block, Corner
from drystone.model.builders import PUBLISHED_WALLS, make_model
from drystone.model.joint_law import JointLaw
from drystone.results.curve import STATIC

Array = NDArray[np.float64]
PAGE = Path(__file__).parent / "reference" / "verification.md"

B, H = 0.4, 0.9  # m, width and height of the rocking block
STIFF = 1e11  # Pa/m
BIAS_AT = 0.1  # m, control displacement on wall 1: no block comes loose near it
BIAS_STEP = (
    2.5e-4  # m, so small that the lag of the recursion behind the falling branch is not felt
)
STEPS = (1e-3, 5e-4, 2.5e-4)  # m
SIZES, MU = (0.4, 0.6, 1.5), 0.7  # m, of the block in space; its friction
ANGLES = (0.0, 30.0, 45.0, 90.0)  # degrees


# ---- models ---------------------------------------------------------------------------------


def block_on_base(
    width: float,
    height: float,
    *,
    friction: float,
    corner: Corner,
    slope: float = 0.0,
    stiffness: float = STIFF,
) -> ds.Model:
    """One block on a long fixed base that falls to the right by ``slope`` [rad]."""
    c, s = np.cos(slope), np.sin(slope)
    turn = np.array([[c, s], [-s, c]])

    def rectangle(left: float, bottom: float, right: float, top: float) -> Array:
        corners = [[left, bottom], [right, bottom], [right, top], [left, top]]
        return np.array(corners) @ turn.T

    blocks = [
        Block(id="base", vertices=rectangle(-1.0, -0.2, 2.0, 0.0), unit_weight=10e3, support=True),
        Block(
            id="block",
            vertices=rectangle(-0.5 * width, 0.0, 0.5 * width, height),
            unit_weight=10e3,
        ),
    ]
    return make_model(
        blocks,
        joint=JointLaw(
            friction_coefficient=friction, normal_stiffness=stiffness, shear_stiffness=stiffness
        ),
        corner=corner,
        thickness=1.0,
        load_direction=(1.0, 0.0),
        control_block="block",
        control_point="top right",
    )


def rocking_block(radius: float) -> ds.Model:
    return block_on_base(B, H, friction=0.8, corner=Corner(radius=radius or None))


# ---- closed forms ---------------------------------------------------------------------------


def rocking_branch(radius: float) -> tuple[Array, Array, Array]:
    """Control displacement [m], multiplier and rotation of a rigid block that rolls on its toe.

    The disc of the corner rolls; its centre is (B/2 - r, r) from the middle of the foot.  The
    load acts at the centroid, so that the multiplier is the weight's arm about the contact over
    the centroid's height.
    """
    theta = np.linspace(0.0, np.arctan(B / H), 20001)
    c, s = np.cos(theta), np.sin(theta)
    arm_x, arm_y = 0.5 * B - radius, 0.5 * H - radius
    multiplier = (arm_x * c - arm_y * s) / (radius + arm_y * c + arm_x * s)
    displacement = radius * theta + radius * (c - 1.0) + (H - radius) * s
    return displacement, multiplier, theta


def last_bias(f: float, c: Array | float) -> Array | float:
    """Applied over static multiplier to which the published recursion converges (theory.md)."""
    return 1.0 / (1.0 - (f - 1.0) / f / c)


# ---- cases ----------------------------------------------------------------------------------


def static(curve: ds.CapacityCurve) -> Array:
    return curve.column("status") == STATIC


def rocking(engine: str, radius: float, **options: float) -> tuple[float, float]:
    """Largest and median difference from the closed form over the branch below the peak."""
    curve = ds.pushover(rocking_block(radius), engine=engine, **options)
    displacement, multiplier, _ = rocking_branch(radius)
    x, y = curve.control_displacement, curve.load_multiplier
    chosen = static(curve) & (x > 0.01 * displacement[-1]) & (x < 0.95 * displacement[-1])
    difference = np.abs(y - np.interp(x, displacement, multiplier))[chosen]
    return float(difference.max()), float(np.median(difference))


def sliding(engine: str, slope: float, friction: float) -> float:
    """Median multiplier of a flat block that slides by 5 cm."""
    model = block_on_base(0.6, 0.2, friction=friction, corner=Corner(), slope=slope)
    curve = ds.pushover(model, engine=engine, max_displacement=0.05)
    chosen = static(curve) & (curve.control_displacement > 0.005)
    return float(np.median(curve.load_multiplier[chosen]))


def rocking_bias(engine: str, f: float) -> tuple[float, float]:
    """Applied over closed-form multiplier of the published strategy, measured and predicted."""
    curve = ds.pushover(
        rocking_block(0.0),
        engine=engine,
        strategy="published",
        overshoot=f,
        displacement_step=BIAS_STEP,
        max_displacement=0.25,
    )
    displacement, multiplier, theta = rocking_branch(0.0)
    x = curve.control_displacement
    chosen = (x > 0.1) & (x < 0.2)
    exact = np.interp(x, displacement, multiplier)
    turned = np.interp(x, displacement, theta)
    height = 0.5 * (H * np.cos(turned) + B * np.sin(turned))
    c = height**2 / ((B**2 + H**2) / 3.0)
    measured = np.median((curve.applied_multiplier / exact)[chosen])
    return float(measured), float(np.median(last_bias(f, c)[chosen]))


def at(curve: ds.CapacityCurve, values: Array, displacement: float, width: float = 0.01) -> float:
    """Median of a column near a control displacement [m]."""
    near = np.abs(curve.control_displacement - displacement) < width
    return float(np.median(values[near]))


def mass_factor(model: ds.Model, curve: ds.CapacityCurve, displacement: float) -> float:
    """The factor c of theory.md from a curve's motion near a control displacement [m]."""
    assembly = model.assembly
    mass = np.where(assembly.fixed[:, None], 0.0, assembly.mass)
    first, last = curve.nearest(displacement - 0.01), curve.nearest(displacement + 0.01)
    v = curve.poses[last] - curve.poses[first]
    momentum = float(np.sum(mass[:, 0] * v[:, 0]))
    return momentum**2 / float(mass[:, 0].sum() * np.sum(mass * v * v))


def wall_bias(engine: str, factors: Sequence[float]) -> list[tuple[float, float, float]]:
    """Overshoot, applied over static multiplier on wall 1, measured and predicted."""
    model = ds.published_wall(1)
    free = ds.pushover(
        model, engine=engine, displacement_step=BIAS_STEP, max_displacement=BIAS_AT + 0.02
    )
    reference = at(free, free.load_multiplier, BIAS_AT)
    rows = []
    for f in factors:
        curve = ds.pushover(
            model,
            engine=engine,
            strategy="published",
            overshoot=f,
            displacement_step=BIAS_STEP,
            max_displacement=BIAS_AT + 0.02,
            keep_poses=True,
        )
        c = mass_factor(model, curve, BIAS_AT)
        measured = at(curve, curve.applied_multiplier, BIAS_AT) / reference
        rows.append((f, measured, float(last_bias(f, c))))
    return rows


# ---- the page -------------------------------------------------------------------------------


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def walls_section(engines: Sequence[str]) -> str:
    rows = []
    for number, wall in PUBLISHED_WALLS.items():
        for engine in engines:
            curve = ds.pushover(ds.published_wall(number), engine=engine)
            end = curve.ultimate_displacement
            residual = curve.residual[static(curve)].max()
            rows.append(
                (
                    str(number),
                    f"{wall.peak_gilbert:.3f}",
                    f"{wall.peak_lmgc90:.3f}",
                    f"{wall.peak_udec:.3f}",
                    f"{wall.ultimate_displacement_lmgc90:.3f}",
                    engine,
                    f"{curve.peak.load_multiplier:.4f}",
                    "-" if end is None else f"{end:.3f}",
                    f"{residual:.1e}",
                    curve.status,
                )
            )
    heads = (
        *("wall", "Gilbert 2006", "LMGC90", "UDEC", "end, LMGC90 [m]"),
        *("engine", "our peak", "our end [m]", "residual", "status"),
    )
    return "\n".join(
        [
            "## The published walls",
            "Table 1 of Bouckaert, Godio and de Almeida (2022): peak multipliers, and the control",
            "displacement at the multiplier 0.01. Theirs are applied multipliers, biased after the",
            "peak as derived in [theory](../explanation/theory.md); ours are static, strategy",
            "`displacement`.",
            "Limit analysis (Gilbert et al. 2006) is of rigid blocks with sharp corners. Residual:",
            "the largest at a static point, over the heaviest block's weight.",
            "",
            table(heads, rows),
        ]
    )


def closed_forms_section(engines: Sequence[str]) -> str:
    rows = []
    for engine in engines:
        for radius in (0.0, 0.02):
            largest, median = rocking(engine, radius)
            peak = (B - 2.0 * radius) / H
            rows.append(
                (
                    engine,
                    f"rocking block, corner radius {radius:g} m: branch from {peak:.4f} to 0",
                    "largest difference of the multiplier",
                    f"{largest:.1e}",
                    f"(median {median:.1e})",
                )
            )
        for slope, friction in ((0.0, 0.3), (np.radians(10.0), 0.5)):
            exact = float(np.tan(np.arctan(friction) - slope))
            ours = sliding(engine, slope, friction)
            rows.append(
                (
                    engine,
                    f"sliding block, friction {friction:g}, plane at {np.degrees(slope):.0f}°",
                    f"multiplier tan(phi - alpha) = {exact:.6f}",
                    f"{ours:.6f}",
                    f"{ours - exact:+.1e}",
                )
            )
    return "\n".join(
        [
            "## Closed forms",
            f"One block {B:g} m wide and {H:g} m high on a fixed base, k_n = k_s = {STIFF:.0e}",
            "Pa/m, turning over its toe: the multiplier is the weight's arm about the contact over",
            "the height of the centroid, the corner's disc rolling. Compared over the branch from",
            "1 % to 95 % of the displacement at which it vanishes, at static points.",
            "A flat block pushed down an inclined plane slides at tan(phi - alpha).",
            "",
            table(("engine", "case", "quantity", "ours", "difference"), rows),
        ]
    )


def steps_section(engines: Sequence[str]) -> str:
    rows = []
    for engine in engines:
        errors = []
        for step in STEPS:
            _, median = rocking(engine, 0.02, displacement_step=step)
            errors.append(median)
        rows.append((engine, *(f"{e:.1e}" for e in errors)))
    return "\n".join(
        [
            "## Step size",
            "Median difference from the closed form of the rocking block with corner radius",
            "0.02 m, by the displacement per step.",
            "",
            table(("engine", *(f"{1e3 * step:g} mm" for step in STEPS)), rows),
        ]
    )


def bias_section(engine: str) -> str:
    factors = (1.005, 1.02, 1.05)
    rows = []
    for f in factors:
        measured, predicted = rocking_bias(engine, f)
        difference = f"{100.0 * (measured / predicted - 1.0):+.1f} %"
        rows.append(("rocking block", f"{f:g}", f"{measured:.4f}", f"{predicted:.4f}", difference))
    for f, measured, predicted in wall_bias(engine, factors):
        difference = f"{100.0 * (measured / predicted - 1.0):+.1f} %"
        rows.append(("wall 1", f"{f:g}", f"{measured:.4f}", f"{predicted:.4f}", difference))
    return "\n".join(
        [
            "## The bias of the published strategy",
            "Applied over static multiplier after the peak, as measured and by the formula of",
            "[theory](../explanation/theory.md);",
            f"engine `{engine}`, {1e3 * BIAS_STEP:g} mm a step. The rocking",
            "block (sharp corners) between 0.1 and 0.2 m against its closed form; wall 1 at",
            f"{BIAS_AT:g} m against the curve of the strategy `displacement`, with c from the",
            "motion of the run itself.",
            "",
            table(("case", "overshoot", "measured", "formula", "difference"), rows),
        ]
    )


def oblique_block(angle: float) -> ds.Model:
    """A block of `SIZES` on a wide base, pushed at an angle [degrees] to its width."""
    blocks = [
        Block(id=name, vertices=vertices, faces=faces, unit_weight=10e3, support=name == "base")
        for name, (vertices, faces) in {
            "base": solid.box([[-1.0, -1.0, -0.2], [1.5, 1.5, 0.0]]),
            "block": solid.box([[0.0, 0.0, 0.0], SIZES]),
        }.items()
    ]
    law = JointLaw(friction_coefficient=MU, normal_stiffness=STIFF, shear_stiffness=STIFF)
    push = (np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0)
    return make_model(blocks, joint=law, load_direction=push)


def space_section(engines: Sequence[str]) -> str:
    rows = []
    b, d, h = SIZES
    for angle in ANGLES:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        exact = min(MU, b / (h * c) if c > 1e-9 else np.inf, d / (h * s) if s > 1e-9 else np.inf)
        model = oblique_block(angle)
        found = {"limit analysis": ds.collapse_load(model, flow="associative").load_multiplier}
        for engine in engines:
            found[engine] = ds.pushover(model, engine=engine).peak.load_multiplier
        for method, ours in found.items():
            difference = f"{ours - exact:+.1e}"
            rows.append((method, f"block, {angle:g}°", f"{exact:.6f}", f"{ours:.6f}", difference))
    for number in PUBLISHED_WALLS:
        plane = ds.published_wall(number)
        exact = ds.collapse_load(plane, flow="associative").load_multiplier
        ours = ds.collapse_load(ds.extruded(plane), flow="associative").load_multiplier
        difference = f"{ours - exact:+.1e}"
        case = f"wall {number} as solids, against the plane"
        rows.append(("limit analysis", case, f"{exact:.6f}", f"{ours:.6f}", difference))
    return "\n".join(
        [
            "## Three dimensions",
            f"One block {b:g} x {d:g} x {h:g} m, friction {MU:g}, pushed at an angle to its width:",
            "the peak is min(mu, b / (h cos), d / (h sin)). Engines have joints of",
            f"{STIFF:.0e} Pa/m, which give way before the block turns. More cases, of random",
            "solids, twisting, flight, arches, domes and façades, are tests:",
            "`tests/verification/test_*solids*.py`, `test_distinct_in_space.py`,",
            "`test_random_contacts.py`, `tests/validation/test_limit_facades.py`.",
            "",
            table(("method", "case", "exact", "ours", "difference"), rows),
        ]
    )


def walls_as_solids_section() -> str:
    rows = []
    for number in PUBLISHED_WALLS:
        model = ds.published_wall(number)
        plane = ds.pushover(model, engine="equilibrium")
        solids = ds.pushover(ds.extruded(model), engine="equilibrium")
        highest = plane.peak.load_multiplier
        both = min(plane.control_displacement.max(), solids.control_displacement.max())
        known = np.argsort(plane.control_displacement, kind="stable")
        on_plane = np.interp(
            solids.control_displacement,
            plane.control_displacement[known],
            plane.load_multiplier[known],
        )
        apart = np.abs(solids.load_multiplier - on_plane)[solids.control_displacement <= both]
        rows.append(
            (
                str(number),
                f"{highest:.5f}",
                f"{100.0 * (solids.peak.load_multiplier / highest - 1.0):+.3f} %",
                f"{100.0 * np.median(apart) / highest:.2f} %",
                f"{plane.control_displacement[-1]:.3f}",
                f"{solids.control_displacement[-1]:.3f}",
                f"{max(point.residual for point in solids.points if point.status == STATIC):.0e}",
            )
        )
    header = ("wall", "peak", "as solids", "median", "last point [m]", "as solids [m]", "residual")
    return "\n".join(
        [
            "### Walls as solids",
            "The published walls, extruded, by the engine `equilibrium`, against its curves in the",
            "plane, which another method follows: the difference of the peaks, and the median of",
            "that of the branches over the peak. After a jump each may find a branch of its own.",
            "",
            table(header, rows),
        ]
    )


def attempt(section: Callable[[], str]) -> str:
    """A section, or the sentence why there is none."""
    try:
        return section()
    except EngineError as error:
        return f"Not run: {error}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engine", action="append", help="may be repeated; default: all")
    chosen = parser.parse_args().engine or [n for n in engine_names() if n != "lmgc90"]
    stepping = "nscd" if "nscd" in chosen else chosen[0]
    sections = [
        "# Verification\n\nWritten by `docs/make_verification.py`; every number of ours comes from"
        f" that run (version {ds.__version__}).",
        attempt(lambda: walls_section(chosen)),
        attempt(lambda: closed_forms_section(chosen)),
        attempt(lambda: steps_section(chosen)),
        attempt(lambda: bias_section(stepping)),
        attempt(lambda: space_section(chosen)),
        attempt(walls_as_solids_section),
    ]
    PAGE.write_text("\n\n".join(sections) + "\n", encoding="utf-8")
    print(PAGE.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
