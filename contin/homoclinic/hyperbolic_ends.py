"""Whether both ends of a connecting orbit still have the manifolds that its conditions take them to have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.kernels.collocation_basis import basis

if TYPE_CHECKING:
    from contin.homoclinic.ends_of_connection import EndsOfConnection
    from contin.problems.orbits.mesh.layout import Profile

FARTHEST: Final = 0.03  # of the cycle's extent, that an end may be from it: bent manifolds are off by its square


def beyond(problem: EndsOfConnection, z: Array) -> str | None:
    """Why the equations mean nothing at z, in words; None where they do."""
    profile = problem.profile(z)
    values = dict(zip(problem.two.parameters, problem.full_parameters(z)[:-1].tolist(), strict=True))
    values |= {name: float(profile.u[0, problem.two.n_states + k]) for k, name in enumerate(problem.two.free)}
    for place in (1, 2):
        of = _of_cycle if place in problem.cycles else _of_equilibrium
        text = of(problem, profile, values, place)
        if text is not None:
            return text
    return None


def _of_cycle(problem: EndsOfConnection, profile: Profile, values: dict[str, float], place: int) -> str | None:
    """The projected modes are the stable ones of a cycle that is left, the others the unstable ones, and vice versa."""
    names, states = problem.two.names, problem.model.state_names
    outside, count = 0.0, 0
    while f"sigma{count}:{place}" in values:
        sigma = values[f"sigma{count}:{place}"]
        if sigma * (1.0 if place == 1 else -1.0) >= 0.0:
            return "a multiplier of the cycle passes the unit circle: its manifolds are others beyond"
        outside, count = outside + sigma, count + 1
    columns = [names.index(f"{name}:cycle{place}") for name in states]
    if len(states) - 1 - count == 1:  # the other multiplier, by Liouville's formula
        other = values[f"period:{place}"] * _mean_divergence(problem, profile, columns, values) - outside
        if other * (1.0 if place == 1 else -1.0) <= 0.0:
            return "a multiplier of the cycle passes the unit circle: its manifolds are others beyond"
    cycle = profile.u[:, columns]
    gap = problem.length(profile.u[0 if place == 1 else -1, : len(states)] - cycle[0])
    part = float(gap / problem.length(np.ptp(cycle, axis=0)))
    if part > FARTHEST:
        return f"the orbit's end is {part:.2g} of the cycle's extent from it, too far for its linear manifolds"
    return None


def _mean_divergence(
    problem: EndsOfConnection, profile: Profile, columns: list[int], values: dict[str, float]
) -> float:  # fmt: skip
    assert problem.flow is not None
    n, scheme = len(columns), basis(profile.m)
    p = np.array([values[name] for name in problem.flow.parameter_names])
    u = np.ascontiguousarray(profile.at(profile.gauss_times)[:, columns])
    matrices = np.asarray(problem.flow.jacobians(u, np.tile(p, (len(u), 1)))[1])[:, :, :n]
    traces = np.trace(matrices, axis1=1, axis2=2).reshape(profile.intervals, profile.m)
    return float(profile.h @ (traces @ scheme.gauss_weights))


def _of_equilibrium(problem: EndsOfConnection, _: Profile, values: dict[str, float], place: int) -> str | None:
    """As many directions lead out of (into) it as the orbit may take."""
    flow, states = problem.flow, problem.model.state_names
    assert flow is not None
    p = np.array([values[name] for name in flow.parameter_names])
    x0 = np.array([values[f"{name}:saddle{place}"] for name in states])
    rates = np.linalg.eigvals(np.asarray(flow.jacobian(x0, p)[1])[:, : len(states)]).real
    count = sum(1 for j in range(len(states)) if f"c{j}:{place}" in values)
    if int(np.sum(rates > 0.0 if place == 1 else rates < 0.0)) != count:
        return "an eigenvalue of the equilibrium passes the imaginary axis: its manifolds are others beyond"
    return None
