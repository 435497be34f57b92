"""Whether a test function along a curve of connections is more than its own errors.

A test that is zero all along a curve (the inclination flip of a plane that drives all other states, the discriminant of
two rates that are one) is computed as rounding, as what Newton's method left, or as the error of the mesh: signs of it
mean nothing. No size tells it from the test of a weak coupling, which is small too. But that one has one sign before
its zero and the other one behind it, in proportion to the distance, and on a finer mesh and a longer interval the same
values.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings

if TYPE_CHECKING:
    from contin.homoclinic.curve_of_connections import CurveOfConnections
    from contin.problems.contracts import Probing

ASIDE: Final = 1e-2  # arclength between values from which the slope of a test is taken
CLOSE: Final = 1e-5  # ... and its rounding, where third differences of a smooth test are far below that
PLACES: Final = np.array([-1.5, -0.5, 0.5, 1.5])
THIRD: Final = np.array([-1.0, 3.0, -3.0, 1.0])
RANDOM: Final = 0.5  # of the largest value: third differences from which on values are no multiples of the distance
ALIKE: Final = 0.25  # of the largest value, by which a finer mesh may change a test that is no error of the mesh
SMALL: Final = 1e-3  # in units of the solution whose part a test is: a larger one is none of these errors
FAINT: Final = 1e-6  # ... and a smaller one that a finer mesh changes is the error of the mesh alone
JUMP: Final = 0.1  # of the change of a test over ASIDE: what is left at its zero where it jumps


def slope_beside(problem: CurveOfConnections, near: Sample, frame: Frame, index: int) -> float | None:
    """Rate of change of a test by arclength; 0 where its values are no more than their errors, None where not known."""
    values = _values(problem, near, frame, index, ASIDE)
    if values is None:
        return None
    size = float(np.abs(values).max())
    if size < SMALL and not _crosses(values):
        return 0.0
    if size < SMALL and not _stays(problem, near, frame, index, values):
        return 0.0 if size < FAINT else None
    return float(np.abs(np.diff(values)).max()) / ASIDE


def jumps(value: float, slope: float | None) -> bool:
    """Whether the test is at its zero still as large as a part of what it changes beside it."""
    return slope is not None and value > JUMP * slope * ASIDE


def displacement(problem: Probing, found: Sample, frame: Frame, index: int, slope: float | None) -> float:
    """How far (arclength) the rounding of a test moves its zero."""
    values = _values(problem, found, frame, index, CLOSE) if slope else None
    if values is None or not slope:
        return 0.0
    return abs(float(THIRD @ values)) / slope


def _values(problem: Probing, near: Sample, frame: Frame, index: int, distance: float) -> Array | None:
    """The test at four places of one distance around a point; None where one of them is not reached."""
    values = np.full(PLACES.size, np.nan)
    for k, s in enumerate(distance * PLACES):
        beside = problem.probe(near, s, near.z + frame.scale * s * near.tangent, frame, Settings())
        if beside is None:
            return None
        values[k] = beside.tests[index]
    return values if np.isfinite(values).all() else None


def _crosses(values: Array) -> bool:
    """Whether values at the places are those of a function with one zero in their middle."""
    signs = np.sign(values)
    opposite = bool(signs[0] == signs[1] == -signs[2] == -signs[3] != 0.0)
    return opposite and abs(float(THIRD @ values)) < RANDOM * float(np.abs(values).max())


def _stays(problem: CurveOfConnections, near: Sample, frame: Frame, index: int, values: Array) -> bool:
    """Whether a finer mesh has the same values; where there is none, nothing is known against them."""
    refined = problem.refined(near, frame)
    again = None if refined is None else _values(*refined, index, ASIDE)
    if again is None:
        return True
    again *= np.sign(again[0] * values[0])  # an adjoint solution has no sense of its own
    return _crosses(again) and float(np.abs(again - values).max()) <= ALIKE * float(np.abs(values).max())
