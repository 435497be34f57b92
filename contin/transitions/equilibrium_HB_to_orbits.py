"""The families of cycles that are born at Hopf points of equilibria."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin import lazy
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.normalforms.hopf import hopf_predictor
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.normal_forms import jet_at
from contin.problems.orbits.collocated_orbits import PERIOD_SCALE, OrbitProblem
from contin.problems.orbits.corotating import system_of_orbits
from contin.problems.orbits.linearised.multipliers import of_rest
from contin.problems.orbits.mesh.layout import HOPF_INTERVALS, Profile, make_scale, node_times
from contin.problems.sparse.as_dense import dense_problem
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.systems.functions.function_problem import in_kernels
from contin.transitions.equivariant_hopf import patterns, through_an_orbit
from contin.transitions.on_surfaces import refuse_sliding
from contin.transitions.registry import Explored, born

MOVED = 1e-4  # part of the parameter's range that the cycles of the size in the metric have moved away at least
LARGEST = 1e4  # ... unless they are larger than this, in units of the equilibrium's sizes: it does not move at all
OWN = 0.05  # a state larger than this part of its size along the equilibria is measured in its size at the Hopf point
FAR = 0.1  # scaled distance from a Hopf point of several families at which one is told from the others

ORBITS: Final = Explored(orbits=True, when=lambda problem: problem.kind == "equilibrium" and problem.sliding is None)
SMALL: Final = Explored(orbits=True, when=lambda problem: dense_problem(problem) is not None)


@born(EquilibriumProblem, "HB", "the periodic orbits", explored=ORBITS)
def hopf_seeds(equilibria: EquilibriumProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The families of cycles born at a Hopf point of equilibria, with direction and curvature of their normal forms.

    There is one, unless symmetries make several pairs of eigenvalues cross together.
    """
    refuse_sliding(equilibria, point)
    if parameter != equilibria.parameters[0]:
        equilibria = equilibria.with_active(parameter, point.z)
    equilibria = replace(equilibria, system=system_of_orbits(equilibria.system))
    jet, omega = jet_at(equilibria, point.z, point.scale[:-1]), float(point.vectors["omega"])
    if int(point.vectors.get("kernel", 1)) == 1:
        return [_hopf_seed(equilibria, point, hopf_predictor(jet, omega))]
    several = patterns(equilibria, point, jet, omega)
    seeds = [_hopf_seed(equilibria, point, hopf_predictor(jet, omega, vectors)) for vectors in several]
    return seeds if len(seeds) == 1 else [through_an_orbit(seed, FAR) for seed in seeds]


def _hopf_seed(equilibria: Any, point: SpecialPoint, cycles: Any) -> Seed:
    n, m = equilibria.n, Settings().points
    period = 2.0 * np.pi / cycles.omega
    h = np.full(HOPF_INTERVALS, 1.0 / HOPF_INTERVALS)
    rest = Profile(m, np.tile(point.z[:-1], (HOPF_INTERVALS * m + 1, 1)), period, h, float(point.z[-1]))
    turns = _turns(m)
    first = 2.0 * (turns[:, None] * cycles.q).real
    second = 2.0 * cycles.at(1.0, turns) - 2.0 * first
    sizes = point.scale[:-1] / np.sqrt(n)
    own = np.abs(point.z[:-1])
    sizes = np.where(own < OWN * sizes, sizes, np.minimum(sizes, own))
    moved = np.sqrt(MOVED * float(point.scale[-1]) / max(abs(float(cycles.p2[0])), 1e-300))
    enlarged = moved * float(np.max(np.abs(2.0 * cycles.q) / sizes))
    if 1.0 < enlarged < LARGEST:  # the cycles grow far beyond the equilibrium's size before the parameter changes
        sizes = np.maximum(sizes, enlarged * np.abs(2.0 * cycles.q) / np.max(np.abs(2.0 * cycles.q) / sizes))
    scale = make_scale(h, m, sizes, PERIOD_SCALE * period, float(point.scale[-1]))
    zeros = np.zeros(len(h))
    d = np.concatenate([first.ravel(), [0.0], zeros, [0.0]]) / scale
    shift = -2.0 * period * cycles.omega2 / cycles.omega
    k = np.concatenate([second.ravel(), [shift], zeros, [2.0 * cycles.p2[0]]]) / scale
    norm = float(np.linalg.norm(d))
    d, k = d / norm, k / elementary.square(norm)
    k = k - float(k @ d) * d
    base = equilibria.base.copy()
    base[equilibria.active] = point.z[-1]
    problem = OrbitProblem(
        in_kernels(equilibria.system), base, equilibria.active, np.zeros(n), m,
        origin=(float(point.z[-1]), point.z[:-1].copy()),
    )  # fmt: skip
    multipliers = of_rest(np.asarray(point.eigenvalues), cycles.omega, period)
    return Seed(problem, rest.vector(), d, k, scale, (1,), Parent.of(point), measured=multipliers)


@cache
def _turns(m: int) -> NDArray[np.complex128]:
    """e^{2 pi i t} at the nodes of a small cycle's mesh."""
    times = node_times(np.full(HOPF_INTERVALS, 1.0 / HOPF_INTERVALS), m)
    return elementary.exp(1j * (2.0 * np.pi * times))


@born(LargeProblem, "HB", "the periodic orbits", explored=SMALL)
def hopf_seeds_of_large(problem: LargeProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """As `hopf_seeds`; where the system is too large to be followed as a dense one, by collocation of sparse ones."""
    function = problem.system.model
    by_columns = function.written is None and function.method == "sparse"
    dense = None if by_columns else dense_problem(problem)
    if dense is not None:
        return hopf_seeds(dense, point, parameter)
    seed: Seed = lazy.module("large cycles").large_cycles(problem, point, parameter)
    return [seed]
