"""Rocking under a record: the equation of motion integrated from impact to impact.

Between impacts x'' = f(x, u_g) with a restoring force that does not vanish at rest; a body at rest
stays so until the ground lifts it.  At an impact velocity drops to a share of itself.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drystone.assessment.capacity import Capacity
from drystone.assessment.errors import AssessmentError, positive
from drystone.assessment.rocking.record import Record
from drystone.common.arrays import Array

#: How it rocks: both ways alike, or one way against something that throws it back.
SIDES = ("two", "one")

#: Tolerance of the integration, relative to the displacement of collapse.
RELATIVE, ABSOLUTE = 1e-8, 1e-10

#: Share of the velocity sqrt(lambda_0 g x_0) below which a body that hits comes to rest.
AT_REST = 1e-5

#: Length of a record over that of its points in steps of the median; of even ones it is 1.
UNEVEN = 10.0

#: Impacts in one response after which something is wrong.
MOST_IMPACTS = 20_000


class Rocker(Protocol):
    """What rocks: its displacement may be a length or an angle."""

    @property
    def limit(self) -> float:
        """Displacement beyond which it counts as overturned."""
        ...

    @property
    def uplift(self) -> float:
        """Acceleration of the ground [m/s2] beyond which it lifts."""
        ...

    @property
    def speed(self) -> float:
        """A velocity of its size, for tolerances."""
        ...

    def acceleration(self, x: float, ground: float) -> float:
        """x'' at x >= 0 on the side of growing x, under an acceleration of the ground [m/s2]."""
        ...


class MechanismRocker:
    """d*'' + lambda(d*) g = -u_g: a capacity in the reading of the energy.

    Overturned where lambda is zero: the collapse displacement is never passed, Circ. 7/2019
    C8.7.1.2.1.9.

    Parameters
    ----------
    confidence_factor
        Accelerations of the capacity are divided by it.
    """

    def __init__(self, capacity: Capacity, confidence_factor: float = 1.0) -> None:
        energy = capacity.read_as("energy")
        end = energy.spectral_collapse_displacement
        if end is None:
            raise AssessmentError(
                "rocking needs the displacement at which nothing is carried any more, and the "
                "curve does not come down to it: trace it to its end"
            )
        d, a = energy.spectral_displacement, energy.spectral_acceleration
        before = d < end
        x, y = np.append(d[before], end), np.append(a[before], 0.0) / confidence_factor
        if x[0] > 0.0:
            x, y = np.append(0.0, x), np.append(y[0], y)
        self._x, self._y = x.tolist(), y.tolist()
        self.limit = float(end)
        self.uplift = float(y[0])
        self.speed = math.sqrt(float(y.max()) * self.limit)

    def restoring(self, x: float) -> float:
        """lambda(d*) g [m/s2], straight on below zero and beyond the collapse."""
        xs, ys = self._x, self._y
        i = min(max(bisect_right(xs, x), 1), len(xs) - 1)
        return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])

    def energy(self, x: float) -> float:
        """Work of the restoring force from rest to x [m2/s2]."""
        total = 0.0
        for i in range(1, len(self._x)):
            low, high = self._x[i - 1], min(self._x[i], x)
            if high <= low:
                break
            total += 0.5 * (self._y[i - 1] + self.restoring(high)) * (high - low)
        return total

    def acceleration(self, x: float, ground: float) -> float:
        """x'' [m/s2] at x [m]."""
        return -self.restoring(x) - ground


@dataclass(frozen=True, kw_only=True, eq=False)
class Response:
    """A history of rocking."""

    time: Array  # (n,) s
    displacement: Array  # (n,) m or rad
    velocity: Array  # (n,)
    n_impacts: int
    overturned: bool

    @property
    def largest(self) -> float:
        """Largest displacement to either side."""
        return float(np.max(np.abs(self.displacement)))


class _History:
    """Points as they come."""

    def __init__(self) -> None:
        self.time: list[Array] = []
        self.x: list[Array] = []
        self.v: list[Array] = []
        self.n_impacts = 0

    def add(self, time: Array, x: Array, v: Array) -> None:
        self.time.append(np.atleast_1d(time))
        self.x.append(np.atleast_1d(x))
        self.v.append(np.atleast_1d(v))

    def response(self, overturned: bool) -> Response:
        return Response(
            time=np.concatenate(self.time),
            displacement=np.concatenate(self.x),
            velocity=np.concatenate(self.v),
            n_impacts=self.n_impacts,
            overturned=overturned,
        )


def respond(
    rocker: Rocker,
    record: Record,
    *,
    restitution: float,
    sides: str,
    displacement: float = 0.0,
    velocity: float = 0.0,
    duration: float | None = None,
) -> Response:
    """How it rocks under a record, from rest unless a displacement or a velocity is given.

    Parameters
    ----------
    restitution
        Velocity after an impact over that before it, 0 to 1.
    sides
        "two": it goes through to the other side, where it rocks alike; "one": it is thrown back.
    duration
        Time to follow it [s], after the record as well; that of the record where left out.
    """
    if not 0.0 <= restitution <= 1.0:
        raise AssessmentError(f"a restitution lies between 0 and 1, not {restitution:g}")
    if sides not in SIDES:
        raise AssessmentError(f'sides "{sides}" are not known: "two" or "one"')
    start = float(record.time[0])
    end = float(record.time[-1]) if duration is None else start + positive(duration, "duration")
    times, values = record.time.tolist(), record.acceleration.tolist()
    ground = _interpolation(times, values)
    step = _longest_step(record)
    history = _History()
    t, x, v = start, float(displacement), float(velocity)
    history.add(np.array(t), np.array(x), np.array(v))
    if abs(x) >= rocker.limit:
        return history.response(True)
    while t < end:
        if x == 0.0 and v == 0.0:
            lifted = _uplift(times, values, t, rocker.uplift, sides)
            if lifted is None or lifted[0] >= end:
                break
            t, sign = lifted
        else:
            sign = math.copysign(1.0, x if x != 0.0 else v)
        shaken = t < times[-1]
        stop = min(end, times[-1]) if shaken else end
        longest = step if shaken else math.inf
        t, x, v, event = _flight(rocker, ground, (t, x, v), stop, sign, longest, history)
        if event == "overturned":
            return history.response(True)
        if event == "impact":
            history.n_impacts += 1
            if history.n_impacts > MOST_IMPACTS:
                raise AssessmentError("rocking does not come to rest: too many impacts")
            x, v = 0.0, v * restitution * (1.0 if sides == "two" else -1.0)
            push = -ground(t) * math.copysign(1.0, v)
            if abs(v) < AT_REST * rocker.speed and push <= rocker.uplift:
                v = 0.0
            history.add(np.array(t), np.array(x), np.array(v))
    history.add(np.array(end), np.array(x), np.array(v))
    return history.response(False)


def _longest_step(record: Record) -> float:
    """That of the record's points in the median [s]: no peak is missed.

    Raises `AssessmentError` where so many of them make up the record that it would have no end.
    """
    step = float(np.median(np.diff(record.time)))
    length = float(record.time[-1] - record.time[0])
    if length > UNEVEN * (len(record.time) - 1) * step:
        raise AssessmentError(
            f"{record.name}: takes {length:g} s, with steps of {step:g} s in the median: give it "
            "in even steps"
        )
    return step


def _flight(
    rocker: Rocker,
    ground: Callable[[float], float],
    state: tuple[float, float, float],
    end: float,
    sign: float,
    longest: float,
    history: _History,
) -> tuple[float, float, float, str]:
    """On one side until it hits, overturns or time ends: time, x, v and which of them."""
    from scipy.integrate import solve_ivp

    def motion(t: float, y: Array) -> list[float]:
        return [y[1], sign * rocker.acceleration(sign * y[0], sign * ground(t))]

    def hits(t: float, y: Array) -> float:
        return sign * y[0]

    def falls(t: float, y: Array) -> float:
        return sign * y[0] - rocker.limit

    def turns(t: float, y: Array) -> float:
        return y[1]

    for event, direction in ((hits, -1.0), (falls, 1.0)):
        event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
    t, x, v = state
    found = solve_ivp(
        motion,
        (t, end),
        [x, v],
        method="RK45",
        rtol=RELATIVE,
        atol=[ABSOLUTE * rocker.limit, ABSOLUTE * rocker.speed],
        max_step=longest,
        first_step=min(1e-3 * min(longest, end - t), 0.5 * (end - t)),
        events=(hits, falls, turns),
    )
    if found.status < 0:
        raise AssessmentError(f"rocking could not be integrated: {found.message}")
    turned = found.t_events[2]  # the largest displacements lie between steps
    order = np.argsort(np.append(found.t, turned), kind="stable")
    both = np.hstack((found.y, np.reshape(found.y_events[2], (-1, 2)).T))[:, order]
    history.add(np.append(found.t, turned)[order], both[0], both[1])
    last = float(found.t[-1]), float(found.y[0, -1]), float(found.y[1, -1])
    if found.status == 1:
        return (*last, "impact" if len(found.t_events[0]) else "overturned")
    return (end, last[1], last[2], "")


def _interpolation(times: list[float], values: list[float]) -> Callable[[float], float]:
    """Acceleration of the ground at a time, zero outside the record."""

    def ground(t: float) -> float:
        if not times[0] <= t <= times[-1]:
            return 0.0
        i = min(bisect_right(times, t), len(times) - 1)
        rise = (values[i] - values[i - 1]) / (times[i] - times[i - 1])
        return values[i - 1] + rise * (t - times[i - 1])

    return ground


def _uplift(
    times: list[float], values: list[float], start: float, threshold: float, sides: str
) -> tuple[float, float] | None:
    """When the ground lifts a body at rest, from a time on, and to which side; None if never.

    The body moves against the ground: to the side of growing x where the ground goes the other way.
    """
    first = max(bisect_right(times, start) - 1, 0)
    for i in range(first, len(times) - 1):
        low, high = times[i], times[i + 1]
        rise = (values[i + 1] - values[i]) / (high - low)
        begin = max(low, start)
        ends = values[i] + rise * (begin - low), values[i + 1]
        for sign in (1.0, -1.0) if sides == "two" else (1.0,):
            push = -sign * ends[0], -sign * ends[1]
            if push[0] > threshold:
                return begin, sign
            if push[1] > threshold:
                return begin + (threshold - push[0]) / (push[1] - push[0]) * (high - begin), sign
    return None


def bearable_scale(
    rocker: Rocker,
    record: Record,
    limit: float,
    *,
    restitution: float,
    sides: str,
    n_points: int = 40,
    most: float = 20.0,
) -> float:
    """The least factor of a record under which a displacement limit is passed.

    Rocking does not grow with the record throughout: factors are tried in ``n_points`` equal steps
    from uplift up to where it fails, and the first failure is refined.  Between the steps a smaller
    one may be missed.
    """

    def fails(factor: float) -> bool:
        found = respond(rocker, record.scaled(factor), restitution=restitution, sides=sides)
        return found.overturned or found.largest > limit

    low = rocker.uplift / record.peak_acceleration
    step = max(low, 1e-3)
    while not fails(low + step):
        if low + 1.5 * step > most * max(low, 1.0):
            raise AssessmentError(
                f"the record does not pass {limit:.4g} at {low + step:.3g} times itself"
            )
        step *= 1.5
    grid = np.linspace(low, low + step, n_points + 1)[1:].tolist()
    last = low
    for factor in grid:
        if fails(factor):
            break
        last = factor
    for _ in range(20):
        middle = 0.5 * (last + factor)
        last, factor = (last, middle) if fails(middle) else (middle, factor)
    return factor
