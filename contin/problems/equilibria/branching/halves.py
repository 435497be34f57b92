"""The half-branches at a branch point whose leading terms do not tell them: what crosses small spheres around it.

A branch through an isolated singular point of analytic equations crosses every small sphere around the point once on
each half (Milnor, Singular Points of Complex Hypersurfaces, 1968, sec. 3), whatever the orders of its terms: parabolas
that touch, cusps, x ~ p^(3/2). So all zeros of the reduced equations on a sphere are found, at the smallest radius at
which they are told apart and are as many as on a sphere twice as large, and each is followed towards the point. A half
behaves like d s + w s^e; its other half is what an odd or even power, or a fractional one, continues to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.problems.equilibria.branching.circle import CircleZeros
from contin.problems.equilibria.branching.outset import Outset
from contin.problems.equilibria.branching.reduced import ReducedEquations
from contin.problems.equilibria.branching.sphere import sphere_zeros

RADII: Final = tuple(0.01 * 2.0**k for k in range(7))  # scaled
TOLD_APART: Final = 1e-5  # distance of two branches from which Newton's method does not confuse them
STRAIGHT: Final = 1e-7  # of the radius: a half this close to its tangent has no power
ALIKE: Final = 0.5  # how far from its expected place (in parts of its deviation) a half is taken for the other one
DENOMINATORS: Final = 4  # of powers
WHOLE: Final = 0.2  # an exponent this near to a whole number is that number
DEEPER: Final = 16  # smaller spheres, each by a factor sqrt(2), on which powers are measured ...
BARELY: Final = 1e-7  # ... while the halves are as far apart
ALONG: Final = 0.99  # cosine between tangents that are one
STEPS: Final = 8  # from a point of the branch to the sphere


@dataclass(frozen=True, eq=False)
class Half:
    """A half-branch: `point` (n + 1,) on the sphere, the unit tangent `direction` at the centre, and the power e."""

    point: Array
    direction: Array
    power: float
    near: Array  # the point nearest to the centre at which it is told from the others

    def deviation(self, offset: Array) -> tuple[float, Array]:
        """s and the vector w s^e of an offset d s + w s^e from the centre."""
        s = float(offset @ self.direction)
        return s, offset - s * self.direction


@dataclass(frozen=True, eq=False)
class Contact:
    """|z1 - z2| ~ |s - s0|^m: the order m, and by how much (n + 1,) the point where they touch is off the centre."""

    order: int
    off: Array


@dataclass(frozen=True, eq=False)
class Fan:
    """All half-branches at a point, as curves of one or two halves; `complete` where none can be missing."""

    reduced: ReducedEquations
    radius: float
    curves: tuple[tuple[Half, ...], ...]
    complete: bool

    @property
    def y(self) -> Array:
        return self.reduced.y

    def outset(self, curve: tuple[Half, ...]) -> Outset:
        """How a curve sets out: +1 is the half along which the parameter, else the first unknown that moves, grows."""
        first, *other = sorted(curve, key=lambda half: _leading(half.point - self.y), reverse=True)
        s, w = first.deviation(first.point - self.y)
        bend = 2.0 * w / elementary.square(s)
        return Outset(first.direction, bend, dict(zip((1, -1), [first.point, *(h.point for h in other)], strict=False)))

    def half_of(self, own: Array) -> Half | None:
        """The half on which a point of a branch near y lies: the branch is followed from there to the sphere."""
        distance = float(np.linalg.norm(self.reduced.kernel.T @ (own - self.y)))
        if distance == 0.0:
            return None
        at: Array | None = own
        for k in range(1, STEPS + 1):
            assert at is not None
            radius = distance * float(elementary.pow(self.radius / distance, k / STEPS))
            ratio = radius / float(np.linalg.norm(self.reduced.kernel.T @ (at - self.y)))
            at = self.reduced.on_sphere(self.y + ratio * (at - self.y), radius)
            if at is None:
                return None
        assert at is not None
        half = min((h for curve in self.curves for h in curve), key=lambda h: float(np.linalg.norm(h.point - at)))
        return half if float(np.linalg.norm(half.point - at)) < 0.5 * TOLD_APART else None

    def curve_of(self, own: Array) -> tuple[Half, Half | None] | None:
        """The half on which `own` lies, and the other half of its curve."""
        half = self.half_of(own)
        for curve in self.curves:
            if half in curve:
                return half, next((h for h in curve if h is not half), None)
        return None

    def contact(self) -> Contact | None:
        """The contact of the two curves that share a tangent; None where there are not just two, or it is unclear."""
        halves = [h for curve in self.curves for h in curve]
        inner = _followed(self.reduced, [h.point for h in halves], 0.5 * self.radius)
        sides = [
            (i, j) for i, a in enumerate(halves) for j, b in enumerate(halves[:i]) if a.direction @ b.direction > ALONG
        ]
        if inner is None or len(halves) != 4 or len(sides) != 2:
            return None
        gaps = [float(np.linalg.norm(halves[i].point - halves[j].point)) for i, j in sides]
        nearer = [float(np.linalg.norm(inner[i] - inner[j])) for i, j in sides]
        # gap = c |s - s0|^m on both sides: the mean of the two powers does not depend on s0 to first order
        power = 0.5 * sum(float(elementary.log2(np.array(a / b))) for a, b in zip(gaps, nearer, strict=True))
        order = round(power)
        if order < 2 or abs(power - order) > WHOLE:
            return None
        roots = [float(elementary.pow(gap, 1.0 / order)) for gap in gaps]
        away = self.radius * (roots[1] - roots[0]) / (roots[0] + roots[1])
        return Contact(order, away * halves[sides[0][0]].direction)


def fan(reduced: ReducedEquations) -> Fan | None:
    """The half-branches at the point; None where no sphere tells them apart."""
    before: list[Array] | None = None
    for inner, outer in pairwise(RADII):
        here = _zeros(reduced, inner) if before is None else before
        beyond = before = None if here is None else _zeros(reduced, outer)
        if here is None or beyond is None or len(here) != len(beyond):
            continue
        halves = _halves(reduced, here, beyond)
        if halves is not None:
            return Fan(reduced, inner, _paired(reduced.y, halves), complete=True)
    return None


def _leading(offset: Array) -> float:
    """What decides which half is the upper one: the parameter, or the first unknown that moves."""
    size = float(np.abs(offset).max())
    return float(offset[-1] if abs(offset[-1]) > 1e-3 * size else offset[np.abs(offset) > 1e-3 * size][0])


def _zeros(reduced: ReducedEquations, radius: float) -> list[Array] | None:
    """The zeros on a sphere, None where they are not all told apart."""
    found = CircleZeros(reduced, radius).points() if reduced.corank == 1 else sphere_zeros(reduced, radius)
    if found is None:
        return None
    return found if _nearest(found) > TOLD_APART else None


def _followed(reduced: ReducedEquations, points: Sequence[Array], radius: float) -> list[Array] | None:
    """The points where the branches cross another sphere."""
    moved = []
    for at in points:
        size = float(np.linalg.norm(reduced.kernel.T @ (at - reduced.y)))
        found = reduced.on_sphere(reduced.y + radius / size * (at - reduced.y), radius)
        if found is None:
            return None
        moved.append(found)
    return moved


def _halves(reduced: ReducedEquations, here: list[Array], beyond: list[Array]) -> list[Half] | None:
    """Zeros on two spheres as half-branches; None where the outer ones do not lead to the inner ones."""
    if not here:
        return []
    radius = float(np.linalg.norm(reduced.kernel.T @ (here[0] - reduced.y)))
    middle = _followed(reduced, beyond, np.sqrt(2.0) * radius)
    inner = None if middle is None else _followed(reduced, middle, radius)
    if middle is None or inner is None:
        return None
    nearest = [int(np.argmin([float(np.linalg.norm(at - z)) for z in here])) for at in inner]
    if sorted(nearest) != list(range(len(here))) or any(
        float(np.linalg.norm(here[k] - at)) > 0.5 * TOLD_APART for k, at in zip(nearest, inner, strict=True)
    ):
        return None
    spheres = [beyond, middle, inner]
    for k in range(1, DEEPER + 1):
        deeper = _followed(reduced, spheres[-1], radius * elementary.pow(2.0, -0.5 * k))
        if deeper is None or _nearest(deeper) < BARELY:
            break
        spheres.append(deeper)
    return [_half(reduced.y, path, path[2]) for path in zip(*spheres, strict=True)]


def _nearest(points: Sequence[Array]) -> float:
    return min((float(np.linalg.norm(a - b)) for i, a in enumerate(points) for b in points[:i]), default=1.0)


def _half(y: Array, path: Sequence[Array], point: Array) -> Half:
    """The limit of directions on ever smaller spheres, whose distance to it falls like s^(e - 1)."""
    units = [(z - y) / float(np.linalg.norm(z - y)) for z in path]
    turns = [float(np.linalg.norm(a - b)) for a, b in pairwise(units)]
    last = max((k for k, turn in enumerate(turns) if turn > STRAIGHT), default=0)
    if last == 0 or turns[0] <= STRAIGHT:
        return Half(point, units[-1], np.inf, path[-1])
    ratio = min(turns[last] / turns[last - 1], 0.95)
    direction = units[last + 1] + (units[last + 1] - units[last]) * ratio / (1.0 - ratio)
    power = 1.0 - 2.0 * float(elementary.log2(np.array(ratio)))
    return Half(point, direction / np.linalg.norm(direction), power, path[last + 1])


def _paired(y: Array, halves: list[Half]) -> tuple[tuple[Half, ...], ...]:
    """Halves of one analytic curve: d s + w s^e with s -> -s in s, or in the root of s that makes e a whole number."""
    costs = sorted((_cost(y, a, b), i, j) for i, a in enumerate(halves) for j, b in enumerate(halves[:i]))
    curves, free = [], set(range(len(halves)))
    for cost, i, j in costs:
        if cost < ALIKE and i in free and j in free:
            free -= {i, j}
            curves.append((halves[i], halves[j]))
    return (*curves, *((halves[i],) for i in sorted(free)))


def _cost(y: Array, a: Half, b: Half) -> float:
    """How far b is from the continuation of a, and a from that of b, in parts of their deviations."""
    return max(_miss(y, a, b), _miss(y, b, a))


def _miss(y: Array, a: Half, b: Half) -> float:
    s, w = a.deviation(a.near - y)
    size = float(np.linalg.norm(w))
    length = float(np.linalg.norm(b.near - y))
    offset = b.near - y
    if abs(length - s) > 0.1 * s:  # looked at on different spheres
        other, w_b = b.deviation(offset)
        bent = w_b * elementary.pow(s / other, b.power) if np.isfinite(b.power) else w_b
        offset = s / other * (offset - w_b) + bent
    if not np.isfinite(a.power) or size < STRAIGHT * s:
        return float(np.linalg.norm(offset + s * a.direction)) / (1e-3 * s)
    power = Fraction(a.power).limit_denominator(DENOMINATORS) if a.power < 10.0 else Fraction(round(a.power))
    along = -1.0 if power.denominator % 2 else 1.0
    across = -1.0 if power.numerator % 2 else 1.0
    return float(np.linalg.norm(offset - along * s * a.direction - across * w)) / size
