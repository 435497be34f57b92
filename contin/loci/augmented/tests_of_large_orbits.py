"""Tests for points of codimension two on curves of special orbits of large systems.

In the order of `contin.special.table.tests_of_orbits`: of the other multipliers that are known (those near the unit
circle or outside) pairs, one at -1 and one at 1, which change sign as one of their kind crosses; cos(theta) of a torus'
angle; and the quadratic coefficient of a fold, or the c or Re d that decides criticality, as part of its terms.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.normalforms.cycles import coefficient
from contin.problems.large_orbits.crossing import vertical_term
from contin.problems.large_orbits.cycle import LargeCycle
from contin.problems.large_orbits.multipliers import critical_index, critical_pair, tests_of
from contin.special.table import special_type, tests_of_orbits

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit import LargeOrbitProblem

BESIDE: Final = 0.03  # distance of a multiplier from the critical one below which their sum tells where it is
UNDECIDED: Final = 1e-7  # of 1/(period size^2): terms of a coefficient this small are rounding
COSINES: Final = ("R1", "R2", "R3", "R4")
CRITICAL: Final = {"LPC": 1.0, "BPC": 1.0, "PD": -1.0}


def measured_at(
    family: LargeOrbitProblem, z: Array, type_: str, second: int
) -> tuple[Array, int, NDArray[np.complex128]]:
    """Tests, the number of unstable multipliers without the critical ones, all multipliers with the trivial one.

    The coefficient of PD and NS is NaN, which is no change of sign (`graded` has it): it costs as much as several rows.
    So are all tests without a critical multiplier.
    """
    values, vectors = family.multipliers(z)
    whole = np.append(1.0 + 0.0j, values)
    critical = critical_places(values, type_)
    if critical is None:  # what is critical is nearest to the unit circle
        beside = np.argsort(np.abs(np.abs(values) - 1.0))[2 if type_ == "NS" else 1 :]
        return np.full(len(tests_of_orbits(type_)), np.nan), tests_of(values[beside])[1], whole
    (pairs, flips, ones), unstable = tests_of(others_of(values, type_))
    if type_ == "BPC":
        return np.array([pairs, flips, ones]), unstable, whole
    k, value, cosines = critical[0], float("nan"), []
    if type_ == "NS":
        cosine = 0.5 * float((values[k] + values[critical[1]]).real)  # of two with product 1, real ones too
        cosines = [cosine - _cosine(name) for name in COSINES]
    if type_ == "LPC":
        value = float(np.prod(_quadratic(LargeCycle.with_critical(family, z, values[k], vectors[:, k]), second)))
    return np.array([pairs, flips, ones, *cosines, value]), unstable, whole


def graded(family: LargeOrbitProblem, z: Array, type_: str) -> float:
    """c of PD or Re d of NS as part of its terms; NaN where these are rounding, and of two real multipliers."""
    values, vectors = family.multipliers(z)
    k = critical_index(values, type_)
    places = critical_places(values, type_)
    if k is None or places is None or k not in places:
        return float("nan")
    return _cubic(LargeCycle.with_critical(family, z, values[k], vectors[:, k]), type_)


def critical_places(values: NDArray[np.complex128], type_: str) -> tuple[int, ...] | None:
    """Indices of what is critical along a curve; None where no multiplier may be that."""
    if type_ == "NS":
        return critical_pair(values)
    k = critical_index(values, type_)
    return None if k is None else (k,)


def _cosine(name: str) -> float:
    found = special_type(name).cosine
    assert found is not None
    return found


def others_of(values: NDArray[np.complex128], type_: str) -> NDArray[np.complex128]:
    """All but the critical multipliers; next to a critical one on the real line, by their sum, which is smooth where
    both meet."""
    if type_ == "NS":
        critical = critical_pair(values)
        assert critical is not None
        return np.delete(values, critical)
    at = CRITICAL[type_]
    order = np.argsort(np.abs(values - at))
    if len(values) > 1 and abs(values[order[1]] - at) < BESIDE:
        near = complex((values[order[0]] + values[order[1]]).real - at)
        return np.append(values[order[2:]], near)
    return np.delete(values, order[0])


def curvature(family: LargeOrbitProblem, z: Array, second: int) -> float:
    """The quadratic coefficient of a fold, as part of its terms; NaN where it has no value."""
    values, vectors = family.multipliers(z)
    k = critical_index(values, "LPC")
    return float("nan") if k is None else _quadratic(
        LargeCycle.with_critical(family, z, values[k], vectors[:, k]), second
    )[0]  # fmt: skip


def _quadratic(cycle: LargeCycle, second: int) -> tuple[float, float]:
    """That of the family along its null vector, and how far the active parameter moves the fold, not the other."""
    try:
        return vertical_term(cycle, second)
    except np.linalg.LinAlgError:  # NaN is no change of sign; a curve whose middle has it says so
        return float("nan"), 1.0


def _cubic(cycle: LargeCycle, type_: str) -> float:
    """c or Re d as part of its terms; NaN where these are rounding (equations that are linear across the cycle)."""
    try:
        found = coefficient(cycle, type_, cycle.theta)
    except (np.linalg.LinAlgError, ZeroDivisionError):  # as above
        return float("nan")
    smallest = UNDECIDED / (cycle.period * float(cycle.mean(cycle.orbit.U, cycle.orbit.U)))
    return found.value.real / found.size if found.size > smallest else float("nan")
