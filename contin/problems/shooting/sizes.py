"""Sizes of the states on an orbit, in which absolute tolerances of its trajectories are measured."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.model.kept import kept_with
from contin.simulate.natural import REMEMBERED, natural_metric

if TYPE_CHECKING:
    from contin.problems.shooting.layout import Nodes
    from contin.problems.shooting.shot_family import ShotFamily
    from contin.systems.protocol import System

EPS: Final = float(np.finfo(float).eps)
ABSOLUTE: Final = 1e-2  # absolute tolerances beside relative ones, in these sizes


def absolute_tolerances(problem: ShotFamily, nodes: Nodes, p: Array, relative: float) -> Array:
    """Of the states (n,), beside a relative tolerance of their trajectories.

    A state's size is its largest modulus at the nodes, or how far it goes in a part of the period; of one that is zero
    and stays so its natural size. One that is zero but for rounding is no more accurate than rounding leaves its
    equation: what cancels there, |f_u| |u| + |f_p| |p|, has an error of some eps of it, for which no step is short
    enough (20,000 steps for 45).  p : with the time, where the flow is forced.
    """
    own, system, part = p.copy(), problem.system, nodes.period / (2.0 * np.pi)
    sizes, lost = np.abs(nodes.u).max(axis=0), np.zeros(problem.n)
    for k, u in enumerate(nodes.u):
        if system.is_forced:
            own[-1] = k * nodes.period / nodes.count
        value, slopes = map(_moduli, system.jacobian(u, own))
        sizes = np.maximum(sizes, value * part)
        lost = np.maximum(lost, EPS * slopes.dot(np.abs(np.concatenate([u, own]))))
    if not sizes.min() > 0.0:
        sizes = np.where(sizes > 0.0, sizes, _natural_sizes(system, nodes.u[0], p[: system.m]))
    if (lost * part > relative * sizes).any():
        lost = lost / max(_rate(system, nodes, p), 1.0 / part)
        sizes = np.where(lost > relative * sizes, lost / (ABSOLUTE * relative), sizes)
    return np.asarray(ABSOLUTE * relative * sizes)


def _moduli(numbers: Array) -> Array:
    """Moduli, 0 of what is not finite; asked for on every flight, of which few are not."""
    moduli = np.abs(numbers)
    return moduli if isfinite(moduli.sum()) else np.nan_to_num(moduli, posinf=0.0)


def _rate(system: System, nodes: Nodes, p: Array) -> float:
    """The fastest rate of the linearised equations at the nodes: an error of the equations lasts no longer."""
    matrices = [np.nan_to_num(system.jacobian(u, p)[1][:, : len(u)], posinf=0.0, neginf=0.0) for u in nodes.u]
    return float(np.abs(np.linalg.eigvals(np.array(matrices))).max())


def _natural_sizes(system: System, u: Array, p: Array) -> Array:
    """Natural sizes of the states (n,) at (u, p); asked for many times of one orbit, so they are remembered."""
    known: dict[tuple[bytes, bytes], Array] = kept_with(system, "natural sizes on orbits", dict)
    place = u.tobytes(), p.tobytes()
    if place not in known:
        if len(known) >= REMEMBERED:
            known.clear()
        known[place] = natural_metric(system, u, p).states
    return known[place]
