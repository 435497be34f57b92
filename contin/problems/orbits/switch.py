"""Families that cross or leave a family of orbits: at branch points and at period doublings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.halting import HALF_PERIOD
from contin.errors import InputError
from contin.machine import elementary
from contin.problems.orbits.layout import Profile, make_scale
from contin.problems.orbits.multiple import crossing_tangents
from contin.problems.orbits.symmetry import halves_alike
from contin.problems.scales import parameter_width


def switch(problem: Any, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the families born at a BPC (the crossing one), a PD (the doubled orbits) or a HOM (see `gluing`)."""
    if parameter != problem.parameters[0] and point.type == "PD":
        return [_doubled(*in_another(problem, point, parameter))]
    if parameter != problem.parameters[0]:
        raise InputError(
            f"{point.branch}.{point.label}: a new family starts along {problem.parameters[0]}; vary another parameter "
            "from one of its orbits"
        )
    if point.type == "BPC":
        return _crossing(problem, point)
    if point.type == "PD":
        return [_doubled(problem, point)]
    if point.type == "HOM":
        from contin.problems.orbits.gluing import glued

        return glued(problem, point)
    raise InputError(
        f"{point.branch}.{point.label}: another family of orbits starts at BPC, PD and HOM only; this is {point.type}"
    )


def in_another(problem: Any, point: SpecialPoint, parameter: str) -> tuple[Any, SpecialPoint]:
    """The same orbit with another parameter free: the doubled orbits are born along every one that moves the point."""
    if parameter not in problem.system.parameter_names:
        names = ", ".join(problem.system.parameter_names)
        raise InputError(f"{point.branch}.{point.label}: no parameter {parameter!r}; the model has {names}")
    other = problem.with_active(parameter, point.z)
    z, scale = point.z.copy(), point.scale.copy()
    z[-1] = other.base[other.active]
    bounds = other.default_range(parameter)
    scale[-1] = parameter_width(other.system.model, parameter, float(z[-1]), bounds or (-np.inf, np.inf))
    return other, replace(point, z=z, scale=scale)


def _crossing(problem: Any, point: SpecialPoint) -> list[Seed]:
    several = crossing_tangents(problem, point.z, point.scale, point.eigenvalues)
    if several:
        return [_along(problem, point, direction) for direction in several]
    own = point.tangent / point.scale
    own = own / np.linalg.norm(own)
    tangents = [t for t in problem.tangents(point.z, point.scale) if abs(float(t @ own)) < 0.999]
    if not tangents:
        raise InputError(f"{point.branch}.{point.label}: no second real family crosses here")
    return [_along(problem, point, min(tangents, key=lambda t: abs(float(t @ own))))]


def _along(problem: Any, point: SpecialPoint, direction: Array) -> Seed:
    symmetries = halves_alike(problem, point.z, direction * point.scale)
    halves = (1,) if symmetries else (-1, 1)
    if direction[-1] < 0.0:
        direction = -direction
    return Seed(
        problem, point.z, direction, None, point.scale, halves, Parent(point.branch, point.label), symmetries,
        measured=(_unstable(point), point.eigenvalues),
    )  # fmt: skip


def _doubled(problem: Any, point: SpecialPoint) -> Seed:
    profile = problem.profile(point.z)
    n, m = problem.n, problem.points
    sizes = problem.sizes(point.z, point.scale)
    nodes = profile.u.size
    v = (point.vectors["right"][:, 0] * point.scale[:nodes]).reshape(-1, n)
    h = np.tile(profile.h / 2.0, 2)
    u = np.concatenate([profile.u, profile.u[1:] + problem.winding])
    doubled = Profile(m, u, 2.0 * profile.period, h, profile.parameter)
    scale = make_scale(h, m, sizes, 2.0 * float(point.scale[nodes]), float(point.scale[-1]))
    direction = np.zeros(scale.size)
    direction[: u.size] = np.concatenate([v, -v[1:]]).ravel()
    direction /= scale
    direction /= np.linalg.norm(direction)
    intervals = None if problem.intervals is None else len(h)
    family = replace(problem, winding=2.0 * problem.winding, multiple=2 * problem.multiple, intervals=intervals)
    return Seed(
        family, doubled.vector(), direction, None, scale, (1,), Parent(point.branch, point.label), (HALF_PERIOD,),
        measured=(_unstable(point), _squared(point.eigenvalues)),
    )  # fmt: skip


def _unstable(point: SpecialPoint) -> int:
    """Multipliers outside the unit circle at the point, the critical one not counted."""
    values = np.abs(point.eigenvalues)
    return int(np.sum(values > 1.0 + 1e-4))


def _squared(values: Any) -> Any:
    return elementary.square(np.asarray(values))
