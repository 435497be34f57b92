"""Past an orbit of a curve that touches a switching surface: the curve has another tangent on the other side.

Where the surface is crossed to a depth d, times and with them the return map have a term in a power of sqrt(d). What
makes an orbit special is then of the form a - k sqrt(d) = 0, on which Newton's method fails from almost everywhere;
with d held, and a parameter solved for instead, it is regular (di Bernardo, Budd, Champneys and Kowalczyk, Piecewise-
smooth Dynamical Systems, 2008, ch. 7). If the flow itself jumps at the surface, 1/sqrt(d) takes the place of sqrt(d),
and there are no such orbits beside the touching one.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation import corrector, march
from contin.continuation.outcome import Failure, Verified
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.loci.shooting.contacts import NEAR, Touch, touches, vertex
from contin.loci.shooting.expansion import Expansion
from contin.loci.shooting.grazing import GrazingCurve
from contin.problems.shooting.grazing import surface
from contin.problems.shooting.phase import rebased
from contin.problems.shooting.sampling import sliding

if TYPE_CHECKING:
    from contin.loci.shooting.shot_curve_equations import ShotCurveEquations


DEPTHS: Final = (1e-5, 1e-4, 1e-3)  # (scaled) beyond the surface at which the curve is taken up again
AHEAD: Final = 1e-3  # (scaled) from the last orbit to the touching one
PASSED: Final = 1e-6  # ... or back to it
LITTLE: Final = 1e-5  # (arclength) ahead, where it is seen whether orbits reach further
FAR: Final = 0.1  # (arclength) beyond which the point found is another one
TOLERANCE: Final = 1e-10
SHORT: Final = 1e-4  # steps (arclength) after which the residual is looked at
WRONG: Final = 1e-7  # ... and what it is at no solution


def nearly_touched(problem: ShotCurveEquations, z: Array) -> Touch | None:
    """Where an orbit of the curve nearly touches a surface; None where it does nowhere."""
    curve = problem.curve
    if not curve.system.n_switches or curve.touched is not None:
        return None
    found = touches(curve.at(z), curve.orbit(z), NEAR)
    return min(found, key=lambda touch: abs(touch.value), default=None)


def cross_corner(problem: ShotCurveEquations, last: Sample, frame: Frame) -> tuple[Sample, Verified | None] | None:
    """The first point on the other side, its tangent pointing away from the corner; None where there is none."""
    touch = nearly_touched(problem, last.z)
    if touch is None:
        return None
    curve, scale = problem.curve, frame.scale
    sense = _sense(curve, last, scale, touch)  # 1: the surface is crossed beyond; -1: it was crossed before
    z, touch = _in_the_middle(curve, last.z, scale, touch)
    found = _gradient(curve, z, scale, touch)
    if found is None:
        return None
    deeper, there = -touch.side * found[0], touch.value * touch.side / found[1]  # there: length to the touching orbit
    if not -PASSED < sense * there < AHEAD:
        return None
    own = problem.settled(z, scale)
    for depth in DEPTHS:
        length = there + sense * depth
        solved = corrector.correct(own, z, deeper, length, length * deeper, scale, TOLERANCE)
        if isinstance(solved, Failure) or float(np.linalg.norm(solved.y)) > FAR:
            continue
        beyond = march.measure(own, solved, frame.reference)
        if sense < 0.0:
            beyond = replace(beyond, tangent=-beyond.tangent, tests=beyond.tests * _turned(beyond))
        return beyond, None
    return None


def _sense(curve: Any, last: Sample, scale: Array, touch: Touch) -> float:
    """1 where orbits ahead on the curve reach further beyond the surface, -1 where they reach less far."""
    ahead = last.z + LITTLE * np.where(last.tangent == 0.0, 0.0, last.tangent * scale)
    values = [
        vertex(lambda t, z=z: surface(curve.at(z), curve.orbit(z), touch.surface, t % 1.0), touch.time, 1.0)[1]
        for z in (last.z, ahead)
    ]
    return 1.0 if touch.side * (values[1] - values[0]) < 0.0 else -1.0


def _in_the_middle(curve: Any, z: Array, scale: Array, touch: Touch) -> tuple[Array, Touch]:
    """The same orbit begun so that it touches the surface in the middle of a segment."""
    orbits, orbit = curve.at(z), curve.orbit(z)
    middle = (int(touch.time * orbits.count) + 0.5) / orbits.count
    if not orbits.autonomous:
        return z, touch
    moved = rebased(orbits, orbit, (touch.time - middle) % 1.0, orbits.sizes(orbit, curve.orbit(scale)))
    return curve.join(moved, float(z[-2]), curve.further(z)), replace(touch, time=middle)


def _turned(sample: Sample) -> Array:
    """Signs of the tests when the tangent turns round."""
    signs = np.ones(sample.tests.size)
    signs[:2] = -1.0
    return signs


def _gradient(curve: Any, z: Array, scale: Array, touch: Touch) -> tuple[Array, float] | None:
    """The unit vector (scaled, of the states only) along which the surface function grows fastest, and how fast."""
    orbit, metric = curve.orbit(z), curve.orbit(scale)
    grazing = GrazingCurve(curve.orbits, curve.second, touch)
    at = Expansion.of(curve.at(z), curve.second, orbit, metric, float(scale[-2]))
    found = None if at is None else grazing.clearance(grazing.join(orbit, float(z[-2])), at)
    if found is None or at is None:
        return None
    row = np.zeros(z.size)
    row[: at.rows - 1] = (found[1] * at.units)[: at.rows - 1]
    unit = float(np.linalg.norm(row))
    return (row / unit, unit) if np.isfinite(unit) and unit > 0.0 else None


def cut_where_wrong(problem: ShotCurveEquations, chunk: Chunk, scale: Array) -> Chunk:
    """The chunk up to the first row that Newton's method only seemed to converge to, where steps are short.

    The corrections stop shrinking near a touching orbit as they do at rounding; the residual tells the two.
    """
    if not problem.system.n_switches:
        return chunk
    for row in range(1, len(chunk)):
        if chunk.lengths[row] < SHORT:
            found = problem.curve.linearise(chunk.z[row], scale)
            if found is None or float(np.linalg.norm(found.residual)) > WRONG:
                return chunk.cut(row, Stop.CORRECTOR, float(chunk.lengths[row]))
    return chunk


def why_not(problem: ShotCurveEquations, z: Array) -> str | None:
    """What a touched surface means for the curve, in words; None where none is near."""
    touch = nearly_touched(problem, z)
    if touch is None:
        return None
    slides = sliding(problem.curve.at(z), problem.curve.orbit(z))
    if slides is not None:
        return slides
    name = problem.curve.system.pieces.name(touch.surface)
    return (
        f"The orbits come to touch {name} there (a grazing orbit), where the return map has no second derivative: no "
        f"{problem.locus} orbits were found on the other side. A fold at the touching orbit itself is labelled LPC "
        "(nonsmooth) on families in one parameter, and its curve starts from there."
    )
