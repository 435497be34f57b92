"""The label of a special orbit that is found: its multipliers, how many of them are critical, its error and form.

Where a symmetry makes several multipliers equal, defining systems of simple points are singular, and Newton's method
finds an orbit off the symmetric one by the root of its residual. It is made symmetric, so that equal ones are equal.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Outcome, Rejected, Verified
from contin.problems.coinciding import OF_ORBITS
from contin.problems.equal_multipliers import repeated
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.linearised.multipliers import critical, distance, nontrivial, without
from contin.problems.orbits.normal_forms.normal_form import normal_form
from contin.problems.orbits.special_orbits.sensitivity import error_of_equations
from contin.problems.orbits.symmetric.symmetry import symmetrised

if TYPE_CHECKING:
    from contin.problems.orbits.linearised.solved_orbit import SolvedOrbit
    from contin.problems.orbits.orbit_equations import OrbitEquations

SOLVED: Final = 1e-8  # scaled residual up to which what is made symmetric is an orbit
CANCELLED: Final = 64.0  # rounding errors of the range: what terms that cancel leave, the same in all samples
UNCLEAR: Final = 0.2  # distance of the computed multiplier from the critical one at which an event is not labelled


def label(problem: OrbitEquations, type_: str, solved: SolvedOrbit, width: float, other: SolvedOrbit | None) -> Outcome:
    """The point with its coefficients; `width` of the parameter's range, `other` a second way of solving for it."""
    own = other is solved
    solved = _symmetric(problem, solved) if type_ in ("BPC", "PD") else solved
    values = problem.multipliers(solved.z)
    targets = critical(type_, solved.theta)
    if not distance(nontrivial(problem, values), targets) < UNCLEAR:
        return Rejected(f"{type_} not labelled: the multipliers are not resolved there")
    count = repeated(nontrivial(problem, values), targets[0]) if type_ in ("BPC", "PD") else 1
    others = without(nontrivial(problem, values), targets * count)
    rounding = np.finfo(float).eps * (abs(float(solved.z[-1])) + CANCELLED * width)
    error = solved.error + rounding + error_of_equations(problem, type_, solved.z, solved.scale, solved.theta)
    point = Verified(
        type_, solved.z, solved.residual, error, values, int(np.sum(np.abs(others) > 1.0)),
        vectors={"right": solved.right, "theta": solved.theta},
    )  # fmt: skip
    if type_ == "PD" and count > 1:
        vectors = {"theta": np.pi, "kernel": count}
        return replace(point, vectors=vectors, remark=OF_ORBITS["PD"].format(count=count))
    return normal_form(problem, point, solved, solved if own else other)


def _symmetric(problem: OrbitEquations, solved: SolvedOrbit) -> SolvedOrbit:
    """On the fixed space of the symmetries that keep the orbit, on both meshes, where it is an orbit there."""

    def moved(z: Array, scale: Array) -> Array:
        found = symmetrised(problem, z)
        if found is z:
            return z
        residual = float(np.abs(OrbitLinear(problem, found, scale, z).residual).max())
        return found if residual <= SOLVED else z

    if not problem.system.model.symmetries:
        return solved
    finer = solved.finer and replace(solved.finer, z=moved(solved.finer.z, solved.finer.scale))
    return replace(solved, z=moved(solved.z, solved.scale), finer=finer)
