"""A small wall and a plausible capacity curve of it, made up without any engine.

Four courses of two and a half units on a base; beyond the peak the upper courses rock as one
about the toe of their lowest bed joint.  The numbers are not those of any analysis.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from drystone.contact.forces import OPEN, SLIDING, STICKING, ContactForces
from drystone.model.assembly import Assembly, Block
from drystone.model.joint_law import JointLaw
from drystone.model.loading import MassPattern
from drystone.model.model import Analysis, Model, Origin
from drystone.model.monitor import ControlPoint
from drystone.results.curve import DYNAMIC, STATIC, CapacityCurve, CurvePoint, RecorderError
from drystone.results.event_log import events_of

UNIT, COURSE = 0.4, 0.175  # m
PEAK, PEAK_AT, END_AT, STOP = 0.5, 0.002, 0.4, 0.01


def rectangle(x: float, y: float, width: float, height: float) -> np.ndarray:
    return np.array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])


def wall_model(
    courses: int = 4, units: int = 2, source: str | None = None, **options: float
) -> Model:
    """Running bond of ``units`` and a half units a course on a base, unit weight 10 kN/m3."""
    length = (units + 0.5) * UNIT
    blocks = [
        Block(
            id="base",
            vertices=rectangle(-0.1, -0.2, length + 0.2, 0.2),
            unit_weight=10e3,
            support=True,
        )
    ]
    for row in range(courses):
        widths = [UNIT] * units
        widths.insert(0 if row % 2 else units, UNIT / 2)
        x = 0.0
        for column, width in enumerate(widths):
            blocks.append(
                Block(
                    id=f"{row + 1}.{column + 1}",
                    vertices=rectangle(x, row * COURSE, width, COURSE),
                    unit_weight=10e3,
                )
            )
            x += width
    joint = JointLaw(friction_coefficient=0.65, normal_stiffness=1e8, shear_stiffness=1e11)
    model = Model(
        title="A made-up wall",
        assembly=Assembly.build(blocks, joint=joint),
        load=MassPattern(direction=np.array([1.0, 0.0])),
        control_point=ControlPoint(
            block=len(blocks) - 1,
            point=np.array([length, courses * COURSE]),
            direction=np.array([1.0, 0.0]),
        ),
        analysis=Analysis(engine="nscd", options=options),
    )
    if source is None:
        return model
    file = Path(source)
    sha256 = hashlib.sha256(file.read_bytes() if file.is_file() else b"").hexdigest()
    return replace(model, origin=Origin(path=source, sha256=sha256, contents=model.contents))


def pose_at(model: Model, control_displacement: float) -> np.ndarray:
    """All courses but the first turned as one about their lower right corner."""
    assembly = model.assembly
    pivot = np.array([model.control_point.point[0], COURSE])
    arm = model.control_point.point - pivot
    angle = -np.arcsin(control_displacement / arm[1])
    cosine, sine = np.cos(angle), np.sin(angle)
    pose = assembly.design_pose()
    upper = assembly.centroid[:, 1] > COURSE
    relative = assembly.centroid[upper] - pivot
    turned = relative @ np.array([[cosine, sine], [-sine, cosine]])
    pose[upper, :2] = turned - relative
    pose[upper, 2] = angle
    return pose


def contacts_at(model: Model, pose: np.ndarray) -> ContactForces:
    """Two points under every block: closed below, open at the rocking joint's left end."""
    n = model.assembly.n_blocks
    blocks = np.repeat(np.arange(1, n + 1), 2)
    below = np.maximum(blocks - 3, 0)
    position = np.vstack(
        [
            model.assembly.outline(i, pose)[k]
            for i, k in zip(blocks, np.tile([0, 1], n), strict=True)
        ]
    )
    angle = pose[blocks, 2]
    status = np.full(2 * n, STICKING)
    status[6:8], status[1] = OPEN, SLIDING
    force = np.where(status == OPEN, 0.0, 350.0 * (1.0 + np.arange(2 * n) % 4))
    return ContactForces(
        block_a=below,
        block_b=blocks,
        position=position,
        normal=np.column_stack((-np.sin(angle), np.cos(angle))),
        gap=np.where(status == OPEN, np.abs(pose[blocks, 1]), -1e-6),
        area=np.full(2 * n, 0.2),
        normal_reaction=force,
        tangential_reaction=(0.3 * force)[:, None],
        status=status,
    )


def point(step: int, control_displacement: float, multiplier: float, **changes: Any) -> CurvePoint:
    values: dict[str, Any] = {
        "step": step,
        "control_displacement": control_displacement,
        "load_multiplier": multiplier,
        "applied_multiplier": multiplier,
        "carried_multiplier": multiplier,
        "residual": 1e-8,
        "penetration": 1e-5,
        "friction_violation": 1e-9,
        "energy_ratio": 0.0,
        "inertia_ratio": 0.0,
        "n_open": 2,
        "n_sticking": 20,
        "n_sliding": 1,
        "motion": 1e-3,
        "time_step": 0.05,
        "n_iterations": 7,
        "status": STATIC,
    }
    return CurvePoint(**(values | changes))


def points(n: int = 60, *, end: float = END_AT, dynamic: bool = True) -> list[CurvePoint]:
    """Up steeply to the peak, down to nothing at ``END_AT``, with one local drop on the way."""
    rising = PEAK_AT * np.linspace(0.0, 1.0, n // 4) ** 2
    falling = np.linspace(PEAK_AT, END_AT, n - n // 4 + 1)[1:]
    made = []
    for step, x in enumerate(np.concatenate((rising, falling))):
        if x > end + 1e-12:
            break
        y = (
            PEAK * np.sqrt(x / PEAK_AT)
            if x <= PEAK_AT
            else PEAK * (1.0 - (x - PEAK_AT) / (END_AT - PEAK_AT))
        )
        jumping = dynamic and 0.2 < x < 0.23
        y -= 0.03 if jumping else 0.0
        made.append(point(step, float(x), float(y), status=DYNAMIC if jumping else STATIC))
    return made


def curve(n: int = 60, *, status: str = "finished", **options: Any) -> CapacityCurve:
    return CapacityCurve(
        engine="nscd",
        strategy="displacement",
        points=tuple(points(n, **options)),
        status=status,
        reason="The load multiplier fell below 0.01.",
        stop_multiplier=STOP,
        wall_time=1.5,
    )


def record(recorder: Any, model: Model, result: CapacityCurve) -> None:
    """What a pushover tells its recorder."""
    recorder.begin(model, result.engine, result.strategy)
    for p in result.points:
        pose = pose_at(model, p.control_displacement)
        recorder.point(p, pose, contacts_at(model, pose))
    recorder.end(result)


def pushover(
    model: Model,
    *,
    engine: str | None = None,
    strategy: str | None = None,
    recorder: Any = None,
    progress: Callable[[CurvePoint], None] | None = None,
    keep_poses: bool = False,
    keep_contacts: bool = False,
    n: int = 60,
    status: str = "finished",
    **_: Any,
) -> CapacityCurve:
    """Stands in for `drystone.analysis.driver.pushover`, the interruption included."""
    result = curve(n, status=status)
    reached, poses, reason = [], [], "Made up."
    if recorder:
        recorder.begin(model, engine or "nscd", strategy or "displacement")
    try:
        for p in result.points:
            pose = pose_at(model, p.control_displacement)
            if recorder:
                recorder.point(p, pose, contacts_at(model, pose))
            reached.append(p)
            poses.append(pose)
            if progress:
                progress(p)
    except KeyboardInterrupt:
        status = "interrupted"
    except RecorderError as error:
        status, reason = "stopped", str(error)
    result = CapacityCurve(
        engine=engine or "nscd",
        strategy=strategy or "displacement",
        points=tuple(reached),
        status=status,
        reason=reason,
        stop_multiplier=STOP,
        wall_time=0.1,
        poses=np.array(poses) if keep_poses else None,
        contacts=tuple(contacts_at(model, p) for p in poses) if keep_contacts else None,
        events=events_of(model, reached, np.array(poses), [contacts_at(model, p) for p in poses]),
    )
    if recorder:
        recorder.end(result)
    return result


def write_model(folder: Path) -> Path:
    path = folder / "wall.toml"
    path.write_text('title = "A made-up wall"\n')
    return path


def environment() -> dict[str, str]:
    """Of a child process that finds the same packages as this one."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}


def python(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run code in a fresh process; its errors are ours."""
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        check=True,
        capture_output=True,
        text=True,
        env=environment(),
    )
