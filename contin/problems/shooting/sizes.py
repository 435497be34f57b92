"""Sizes of the states on an orbit, in which absolute tolerances of its trajectories are measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.model.kept import kept_with
from contin.simulate.natural import REMEMBERED, natural_metric

if TYPE_CHECKING:
    from contin.problems.shooting.layout import Nodes
    from contin.problems.shooting.shot_family import ShotFamily
    from contin.systems.protocol import System

ABSOLUTE: Final = 1e-2  # absolute tolerances beside relative ones, in these sizes


def absolute_tolerances(problem: ShotFamily, nodes: Nodes, p: Array, relative: float) -> Array:
    """Of the states (n,), beside a relative tolerance of their trajectories.

    A state's size is its largest modulus at the nodes, or how far it goes in a part of the period; of one that is zero
    and stays so its natural size.  p : with the time, where the flow is forced.
    """
    own, system = p.copy(), problem.system
    sizes = np.abs(nodes.u).max(axis=0)
    for k, u in enumerate(nodes.u):
        if system.is_forced:
            own[-1] = k * nodes.period / nodes.count
        going = np.nan_to_num(np.abs(system.value(u, own)), posinf=0.0) * nodes.period / (2.0 * np.pi)
        sizes = np.maximum(sizes, going)
    if not np.all(sizes > 0.0):
        sizes = np.where(sizes > 0.0, sizes, _natural_sizes(system, nodes.u[0], p[: system.m]))
    return np.asarray(ABSOLUTE * relative * sizes)


def _natural_sizes(system: System, u: Array, p: Array) -> Array:
    """Natural sizes of the states (n,) at (u, p); asked for many times of one orbit, so they are remembered."""
    known: dict[tuple[bytes, bytes], Array] = kept_with(system, "natural sizes on orbits", dict)
    place = u.tobytes(), p.tobytes()
    if place not in known:
        if len(known) >= REMEMBERED:
            known.clear()
        known[place] = natural_metric(system, u, p).states
    return known[place]
