"""Families that cross or leave a family of orbits: at branch points and at period doublings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.problems.orbits.layout import Profile, make_scale


def switch(problem: Any, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the families born at a BPC (the crossing one) or a PD (the doubled orbits), with `parameter` free."""
    if parameter != problem.parameters[0]:
        raise InputError(
            f"{point.branch}.{point.label}: a new family starts along {problem.parameters[0]}; vary another parameter from "  # noqa: E501
            "one of its orbits"
        )
    if point.type == "BPC":
        return [_crossing(problem, point)]
    if point.type == "PD":
        return [_doubled(problem, point)]
    raise InputError(
        f"{point.branch}.{point.label}: another family of orbits starts at BPC and PD only; this is {point.type}"
    )


def _crossing(problem: Any, point: SpecialPoint) -> Seed:
    own = point.tangent / point.scale
    own = own / np.linalg.norm(own)
    tangents = [t for t in problem.tangents(point.z, point.scale) if abs(float(t @ own)) < 0.999]
    if not tangents:
        raise InputError(f"{point.branch}.{point.label}: no second real family crosses here")
    direction = min(tangents, key=lambda t: abs(float(t @ own)))
    halves = (1,) if halves_alike(problem, point.z, direction * point.scale) else (-1, 1)
    if direction[-1] < 0.0:
        direction = -direction
    return Seed(
        problem, point.z, direction, None, point.scale, halves, Parent(point.branch, point.label),
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
        family, doubled.vector(), direction, None, scale, (1,), Parent(point.branch, point.label),
        measured=(_unstable(point), _squared(point.eigenvalues)),
    )  # fmt: skip


def _unstable(point: SpecialPoint) -> int:
    """Multipliers outside the unit circle at the point, the critical one not counted."""
    values = np.abs(point.eigenvalues)
    return int(np.sum(values > 1.0 + 1e-4))


def _squared(values: Any) -> Any:
    return np.asarray(values) ** 2


def shifted(problem: Any, u: Profile, fraction: float) -> Array:
    """u(x + fraction) at the nodes of u, (K, n); what angles gained in a period is added after it."""
    times = u.times + fraction
    turns = np.floor(times)
    return np.asarray(u.at(times - turns) + turns[:, None] * problem.winding)


def halves_alike(problem: Any, z: Array, direction: Array) -> str | None:
    """The declared symmetry (with a half-period shift, or none) that keeps the orbit and turns the raw `direction`
    round.

    At a branch point the two halves of the new family are then images of each other.
    """
    profile = problem.profile(z)
    moved = direction.copy()
    moved[profile.u.size + 1 : -1] = profile.h
    change = problem.profile(moved)
    size = float(np.abs(change.u).max())
    if size == 0.0:
        return None
    step = 1e-4 / size
    p = problem.full_parameters(z)
    for symmetry in problem.system.model.symmetries:
        for fraction in (0.0, 0.5):
            images = []
            for sign in (0.0, step, -step):
                bent = replace(profile, u=profile.u + sign * change.u)
                images.append(
                    problem.system.symmetry(symmetry.name, np.ascontiguousarray(shifted(problem, bent, fraction)), p)
                )
            reference = max(float(np.ptp(profile.u, axis=0).max()), 1e-12)
            if float(np.abs(images[0] - profile.u).max()) > 1e-3 * reference:
                continue
            derivative = (images[1] - images[2]) / (2.0 * step)
            if float(np.abs(derivative + change.u).max()) < 1e-2 * size:
                return str(symmetry.name)
    return None


def symmetry_of(problem: Any, z: Array) -> tuple[str, float] | None:
    """A declared symmetry under which the orbit as a set is its own image: its name and the shift (0 or half a period)."""  # noqa: E501
    profile = problem.profile(z)
    reference = max(float(np.ptp(profile.u, axis=0).max()), 1e-12)
    p = problem.full_parameters(z)
    for symmetry in problem.system.model.symmetries:
        for fraction in (0.0, 0.5):
            image = problem.system.symmetry(symmetry.name, np.ascontiguousarray(shifted(problem, profile, fraction)), p)
            if float(np.abs(image - profile.u).max()) < 1e-3 * reference:
                return str(symmetry.name), fraction
    return None
