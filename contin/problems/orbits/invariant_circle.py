"""Families that end on a fold of equilibria: a saddle-node on an invariant circle.

Near the fold p* the orbit passes a bottleneck, where it spends the time C |p - p*|^(-1/2), so that
p* = p + (T / 2) dp/dT up to the part of the period that is spent elsewhere. The fold itself is solved for.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.problem import Frame, Sample, Verified
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.saddles import extent_of, rounded, slowest_points

DWELT = 0.6  # part of the period spent in the bottleneck from which a fold is looked for
REACHED = 1e-4  # distance of the parameter from the fold, relative to its range, at which the family is complete
RATIOS = (0.6, 2.8)  # of the distance by the period's growth and the distance of the fold: 1 to 1 / DWELT, and doubt
NEAR = 0.1  # of the orbit's extent: distance of the bottleneck from the fold


def fold_passed(problem: Any, profile: Profile, sizes: Array, width: float) -> tuple[Array, float] | None:
    """The fold of equilibria (u, p) in whose bottleneck the orbit spends its time, and the error of p."""
    from contin.problems import defining

    slowest = slowest_points(profile, sizes)
    if len(slowest) != 1:
        return None
    metric = np.append(np.sqrt(problem.n) * sizes, width)
    local = _equilibria(problem).scaled(metric)
    solved = defining.fold(local, np.append(slowest[0], profile.parameter) / metric)
    if solved is None or not solved.residual < 1e-8:
        return None
    found = solved.y * metric
    extent = extent_of(profile, sizes)
    near = float(np.max(np.abs(found[:-1] - slowest[0]) / sizes)) <= NEAR * extent
    return (found, solved.error * width) if near else None


def _equilibria(problem: Any) -> Any:
    from contin.problems.equilibrium import EquilibriumProblem

    return EquilibriumProblem(problem.system, problem.base.copy(), problem.active)


def invariant_circle(problem: Any, origin: Sample, before: Sample, frame: Frame) -> tuple[End, Verified] | None:
    """The fold of equilibria that the family has come to, or None."""
    from contin.problems.orbits.problem import dwelling

    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    if profile.period <= problem.profile(before.z).period or dwelling(profile, sizes) < DWELT:
        return None
    raw = origin.tangent * frame.scale
    width, position = float(frame.scale[-1]), profile.u.size
    fold = fold_passed(problem, profile, sizes, width)
    if fold is None or raw[position] == 0.0:
        return None
    found, doubt = fold
    distance = float(found[-1]) - profile.parameter
    if abs(distance) > REACHED * width:
        return None
    expected = 0.5 * profile.period * float(raw[-1] / raw[position])
    if distance == 0.0 or not RATIOS[0] < expected / distance < RATIOS[1]:
        return None
    name = problem.parameters[0]
    values = np.linalg.eigvals(_equilibria(problem).linear_part(found))
    state = {k: rounded(v, found[:-1]) for k, v in zip(problem.system.state_names, found[:-1], strict=True)}
    where = ", ".join(f"{k} = {v:.8g}" for k, v in state.items())
    at, error = float(found[-1]), doubt
    text = (
        f"the period grows without bound (here {profile.period:.6g}): saddle-node on an invariant circle at "
        f"{name} = {at:.12g}, at the fold of equilibria ({where})"
    )
    data = {
        "at": {name: at}, "error": error, "saddle": state, "saddle_quantity": None, "saddle_node": True,
        "eigenvalues": values[np.argsort(-values.real)].astype(complex),
    }  # fmt: skip
    form = {"at": {name: at}, "kind": "saddle-node"}
    point = Verified("HOM", origin.z, abs(distance), error, origin.eigenvalues, origin.unstable, normal_form=form)
    return End("homoclinic", text, data), point
