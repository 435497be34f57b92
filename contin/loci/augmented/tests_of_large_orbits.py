"""Tests for points of codimension two on curves of folds, period doublings and torus bifurcations of large orbits.

In the order of `contin.special.table.tests_of_orbits`: of the other multipliers that are known (those near the unit
circle or outside) pairs, one at -1 and one at 1, which change sign as one of their kind crosses; cos(theta) of a torus'
angle; and the quadratic coefficient of a fold, or the c or Re d that decides criticality, as part of its terms.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary
from contin.normalforms.cycles import coefficient
from contin.problems.large_orbits.crossing import vertical_term
from contin.problems.large_orbits.cycle import LargeCycle
from contin.problems.large_orbits.multipliers import critical_index, tests_of
from contin.special.table import special_type

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit import LargeOrbitProblem

BESIDE: Final = 0.03  # distance of a multiplier from the critical one below which their sum tells where it is
UNDECIDED: Final = 1e-7  # of 1/(period size^2): terms of a coefficient this small are rounding
COSINES: Final = ("R1", "R2", "R3", "R4")
CRITICAL: Final = {"LPC": 1.0, "PD": -1.0}


def measured_at(
    family: LargeOrbitProblem, z: Array, type_: str, graded: bool = True
) -> tuple[Array, int, NDArray[np.complex128]]:
    """Tests, the number of unstable multipliers without the critical ones, all multipliers with the trivial one.

    graded : False: the coefficient is NaN, which is no change of sign; so are all tests without a critical multiplier.
    """
    values, vectors = family.multipliers(z)
    whole = np.append(1.0 + 0.0j, values)
    k = critical_index(values, type_)
    if k is None:  # the pair has met on the real line, say; what is critical is nearest to the unit circle
        beside = np.argsort(np.abs(np.abs(values) - 1.0))[2 if type_ == "NS" else 1 :]
        return np.full(4 if type_ != "NS" else 8, np.nan), tests_of(values[beside])[1], whole
    others = others_of(values, type_)
    (pairs, flips, ones), unstable = tests_of(others)
    cycle, value = LargeCycle.with_critical(family, z, values[k], vectors[:, k]), float("nan")
    cosines = [float(elementary.cos(cycle.theta)) - _cosine(name) for name in COSINES] if type_ == "NS" else []
    if graded:
        value = _quadratic(cycle) if type_ == "LPC" else _cubic(cycle, type_)
    return np.array([pairs, flips, ones, *cosines, value]), unstable, whole


def _cosine(name: str) -> float:
    found = special_type(name).cosine
    assert found is not None
    return found


def others_of(values: NDArray[np.complex128], type_: str) -> NDArray[np.complex128]:
    """All but the critical multipliers; next to a critical one on the real line, by their sum, which is smooth where
    both meet."""
    if type_ == "NS":
        k = critical_index(values, type_)
        assert k is not None
        return np.delete(values, [k, int(np.argmin(np.abs(values - values[k].conj())))])
    at = CRITICAL[type_]
    order = np.argsort(np.abs(values - at))
    if len(values) > 1 and abs(values[order[1]] - at) < BESIDE:
        near = complex((values[order[0]] + values[order[1]]).real - at)
        return np.append(values[order[2:]], near)
    return np.delete(values, order[0])


def _quadratic(cycle: LargeCycle) -> float:
    """-p'' of the family along its null vector, as part of its terms."""
    try:
        return vertical_term(cycle)
    except np.linalg.LinAlgError:  # NaN is no change of sign; a curve whose middle has it says so
        return float("nan")


def _cubic(cycle: LargeCycle, type_: str) -> float:
    """c or Re d as part of its terms; NaN where these are rounding (equations that are linear across the cycle)."""
    try:
        found = coefficient(cycle, type_, cycle.theta)
    except (np.linalg.LinAlgError, ZeroDivisionError):  # as above
        return float("nan")
    smallest = UNDECIDED / (cycle.period * float(cycle.mean(cycle.orbit.U, cycle.orbit.U)))
    return found.value.real / found.size if found.size > smallest else float("nan")
