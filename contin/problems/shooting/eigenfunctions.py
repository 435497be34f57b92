"""Eigenfunctions of the multipliers of an orbit that is shot: eigenvectors of the monodromy matrix, carried along."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import InputError
from contin.problems.orbits.normal_forms.eigenfunctions import normalised
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.sampling import RTOL, segments_of
from contin.problems.shooting.sizes import absolute_tolerances
from contin.simulate.flight import fly

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations


def eigenfunctions(
    problem: ShotEquations, z: Array, multipliers: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """(k, times, n) at the times of `problem.profile`; they jump where a surface is crossed (saltation)."""
    n, nodes = problem.n, Nodes.of(z, problem.n)
    p, times, length = problem.full_parameters(z), problem.profile(z).times, nodes.period / nodes.count
    owners, atol = segments_of(times, nodes.count), absolute_tolerances(problem, nodes, p, RTOL)
    carried, before = np.empty((len(times), n, n)), np.eye(n)
    for i, u in enumerate(nodes.u):
        wanted = np.minimum(times[owners == i] * nodes.period, (i + 1) * length)
        flight = fly(
            problem.system, u, p, (i + 1) * length - i * length, start=i * length, times=wanted, variations=np.eye(n),
            rtol=RTOL, atol=atol, budget=problem.budget, pieces=problem.held.get(i),
        )  # fmt: skip
        if flight.outcome != "done" or len(flight.samples) != len(wanted):
            raise InputError(f"the orbit has no eigenfunctions here: its trajectory stops ({flight.why})")
        parts = flight.samples[:, n:].reshape(-1, n, n).transpose(0, 2, 1)
        carried[owners == i] = parts @ before
        before = flight.variations @ before
    values, vectors = np.linalg.eig(before)
    found = np.full((len(multipliers), len(times), n), np.nan, complex)
    left = list(range(n))
    for k, rho in enumerate(multipliers):
        if np.isfinite(rho) and left:
            nearest = min(left, key=lambda j: abs(values[j] - rho))
            left.remove(nearest)
            found[k] = normalised(np.asarray(carried @ vectors[:, nearest], complex))
    return found
