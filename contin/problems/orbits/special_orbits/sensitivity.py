"""How errors of the equations themselves reach the parameter of a special orbit: those of averages by quadrature, say.

F(x) = 0 are the collocation equations, x = (u, T, p), V v = 0 the condition that makes the orbit special. With F + dF
and V + dV the parameter moves by

    dp = -(a . dF + beta w^* dV v),   a F_x = e_p - beta (w^* V v)_x,

where w is the left null vector of V, and beta such that the right-hand side vanishes on the null vectors of F_x. On LPC
the tangent has no component p, so beta = 0. At a branch point F_x itself has two null vectors, V v stands for F_x
applied to each, and a second beta belongs to the second.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array, Vector
from contin.machine import elementary
from contin.problems.orbits.linearised.bordered import Bordered
from contin.problems.orbits.linearised.linear import OrbitLinear

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations


def error_of_equations(problem: OrbitEquations, type_: str, z: Array, scale: Array, theta: float = 0.0) -> float:
    """What the relative accuracy of the equations and their derivatives (`Limit.accuracy`) leaves of p, in its unit.

    Zero for equations that are exact, infinite where it cannot be told. Cost: some sparse factorisations.
    """
    accuracy = max((limit.accuracy for limit in problem.system.limits), default=0.0)
    if accuracy == 0.0:
        return 0.0
    try:
        reach = sensitivity(OrbitLinear(problem, z, scale, z), type_, theta)
    except np.linalg.LinAlgError:
        return np.inf
    return accuracy * reach * float(scale[-1])


def sensitivity(linear: OrbitLinear, type_: str, theta: float = 0.0) -> float:
    """Bound of |dp| (scaled) for relative errors 1 of the equations and of their derivatives."""
    count = 2 if type_ == "BPC" else 1
    right, _, left = Bordered.of(linear.jacobian, count).solve()
    kernel, dual = np.linalg.qr(right)[0], np.linalg.qr(left)[0]
    conditions = _conditions(linear, type_, theta, kernel, dual)
    wanted = np.zeros(linear.nu + 2)
    wanted[-1] = 1.0
    weights = np.zeros(0)
    if conditions:
        along = np.array([row @ kernel for row, _ in conditions])  # (conditions, null vectors)
        weights = np.linalg.solve(along.T, wanted @ kernel)
        wanted = wanted - weights @ np.array([row for row, _ in conditions])
    bordered = Bordered.with_borders(linear.jacobian, dual, kernel)
    a = bordered.factors.solve(np.append(wanted, np.zeros(count - 1)), "T")[: linear.nu + 1]
    sizes = _sizes(linear)
    return float(np.abs(a) @ sizes) + sum(
        abs(float(weight)) * float(reach @ sizes[: len(reach)])
        for weight, (_, reach) in zip(weights, conditions, strict=True)
    )


def _conditions(linear: OrbitLinear, type_: str, theta: float, kernel: Array, dual: Array) -> list[tuple[Array, Array]]:
    """(w^* V v)_x of each condition, and |w| times the size of v, row by row."""
    if type_ == "LPC":
        return []
    if type_ == "BPC":
        return [(dual[:, 0] @ linear.hessian(v), np.abs(dual[:, 0]) * _length(linear, v)) for v in kernel.T]
    rho = -1.0 if type_ == "PD" else complex(elementary.exp(1j * theta))
    rights, _, lefts = Bordered.of(linear.variational(rho), 1).solve()
    v = np.append(rights[:, 0], [0.0, 0.0])
    w = lefts[:, 0] if type_ == "PD" else _aligned(linear, rho, rights[:, 0], lefts[:, 0])
    row = np.real(w.conj() @ linear.hessian(v, variational=True))
    return [(row, np.abs(w) * _length(linear, v))]


def _length(linear: OrbitLinear, v: Vector) -> float:
    """The largest component of a direction (nu + 2,), relative to the sizes of states, period and parameter."""
    nodes = (v[: linear.nu] * linear.units[: linear.nu]).reshape(-1, linear.profile.n) / linear.sizes
    return float(max(np.abs(nodes).max(), np.abs(v[linear.nu :]).max()))


def _aligned(linear: OrbitLinear, rho: complex, v: Vector, w: Vector) -> Vector:
    """w turned so that the real part of w^* V v does not depend on the angle: V v has -rho v(0) in its last rows."""
    n = linear.profile.n
    by_angle = complex(w[-n:].conj() @ (-1j * rho * v[:n] * linear.units[:n] / linear.sizes))
    return np.asarray(w * (-1j * by_angle / abs(by_angle)))


def _sizes(linear: OrbitLinear) -> Array:
    """Of the terms of each row (scaled) that the equations have a part in, (nu + 1,), and those of its derivatives.

    Averages and their derivatives may vanish where the functions that are averaged do not (at branch points all of one
    row do), so the largest rate of all states and of the whole orbit counts for each.
    """
    profile, n = linear.profile, linear.profile.n
    steps = np.repeat(profile.h * profile.period, profile.m * n)
    by_state = np.abs(linear.state_derivatives) * linear.sizes / linear.sizes[:, None]
    by_parameter = np.abs(linear.by_parameter[: len(steps)] / steps).max() * linear.units[-1]
    rate = max(float(by_state.max()), float(by_parameter), float(np.abs(linear.field / linear.sizes).max()))
    return np.append(steps * rate, np.zeros(n + 1))
