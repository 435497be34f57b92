"""Where families of periodic orbits start: at a Hopf point, or at an orbit that is already known."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.orbits.layout import Profile, make_scale, sizes_of
from contin.problems.orbits.problem import PERIOD_SCALE, OrbitProblem
from contin.problems.symmetry import symmetry_names

MOVED = 1e-4  # part of the parameter's range that the cycles of the size in the metric have moved away at least
LARGEST = 1e4  # ... unless they are larger than this, in units of the equilibrium's sizes: it does not move at all
OWN = 0.05  # a state larger than this part of its size along the equilibria is measured in its size at the Hopf point
FAR = 0.1  # scaled distance from a Hopf point of several families at which one is told from the others
MOST = 4  # pairs of eigenvalues at once
HOPF_INTERVALS = 20  # a small cycle is a sine


@dataclass(frozen=True, eq=False)
class PeriodicOrbit:
    """An orbit at fixed parameters p: the start of a continuation."""

    system: Any
    profile: Profile
    p: Array
    winding: Array
    multiple: int = 1

    @property
    def period(self) -> float:
        return self.profile.period

    def problem(self, parameter: str, intervals: int | None = None) -> OrbitProblem:
        """The continuation problem with this parameter free."""
        active = list(self.system.parameter_names).index(parameter)
        return OrbitProblem(self.system, self.p, active, self.winding, self.profile.m, intervals, self.multiple)

    def seed(self, parameter: str) -> Seed:
        problem = self.problem(parameter)
        z = replace(self.profile, parameter=float(self.p[problem.active])).vector()
        return Seed(problem, z, symmetries=symmetry_names(problem))

    def __str__(self) -> str:
        low, high = self.profile.u.min(axis=0), self.profile.u.max(axis=0)
        names = self.system.state_names
        states = ", ".join(f"{k} in [{a:.6g}, {b:.6g}]" for k, a, b in zip(names, low, high, strict=True))
        return f"periodic orbit of period {self.period:.10g}, {states}"


def hopf_seeds(equilibria: Any, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The families of cycles born at a Hopf point of equilibria, with direction and curvature of their normal forms.

    There is one, unless symmetries make several pairs of eigenvalues cross together.
    """
    from contin.normalforms.hopf import hopf_predictor
    from contin.problems.describe import jet_at
    from contin.problems.orbits.equivariant import patterns, through_an_orbit

    if parameter != equilibria.parameters[0]:
        equilibria = equilibria.with_active(parameter, point.z)
    jet, omega = jet_at(equilibria, point.z, point.scale[:-1]), float(point.vectors["omega"])
    several = patterns(equilibria, point, omega) if 1 < int(point.vectors.get("kernel", 1)) <= MOST else []
    if not several:
        return [_hopf_seed(equilibria, point, hopf_predictor(jet, omega))]
    seeds = [_hopf_seed(equilibria, point, hopf_predictor(jet, omega, vectors)) for vectors in several]
    return [through_an_orbit(seed, FAR) for seed in seeds]


def _hopf_seed(equilibria: Any, point: SpecialPoint, cycles: Any) -> Seed:
    n, m = equilibria.n, Settings().points
    period = 2.0 * np.pi / cycles.omega
    h = np.full(HOPF_INTERVALS, 1.0 / HOPF_INTERVALS)
    rest = Profile(m, np.tile(point.z[:-1], (HOPF_INTERVALS * m + 1, 1)), period, h, float(point.z[-1]))
    phases = 2.0 * np.pi * rest.times
    first = 2.0 * (elementary.exp(1j * phases)[:, None] * cycles.q).real
    second = 2.0 * cycles.orbit(1.0, phases) - 2.0 * first
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
        equilibria.system, base, equilibria.active, np.zeros(n), m, origin=(float(point.z[-1]), point.z[:-1].copy())
    )
    multipliers = _multipliers_of_rest(point, cycles.omega, period)
    return Seed(problem, rest.vector(), d, k, scale, (1,), Parent(point.branch, point.label), measured=multipliers)


def _multipliers_of_rest(point: SpecialPoint, omega: float, period: float) -> tuple[int, Any]:
    """Unstable count (the critical pair not counted) and multipliers exp(l T) of the equilibrium as an orbit."""
    values = np.asarray(point.eigenvalues)
    order = np.argsort(np.minimum(np.abs(values - 1j * omega), np.abs(values + 1j * omega)))
    others = values[order[2:]]
    with np.errstate(over="ignore"):
        multipliers = np.concatenate([[1.0, 1.0], elementary.exp(others * period)]).astype(complex)
    return int(np.sum(others.real > 0.0)), multipliers


def configured(seed: Seed, settings: Settings) -> Seed:
    """The seed on the mesh that the settings ask for: number of Gauss points, fixed number of intervals."""
    problem: OrbitProblem = seed.problem  # type: ignore[assignment]
    if problem.points == settings.points and settings.intervals is None:
        return seed
    profile = problem.profile(seed.z)
    h = profile.h
    if settings.intervals is not None and settings.intervals != len(h):
        h = np.diff(np.interp(np.linspace(0, 1, settings.intervals + 1), np.linspace(0, 1, len(h) + 1), profile.mesh))
    changed = replace(problem, points=settings.points, intervals=settings.intervals)

    def moved(z: Array) -> Array:
        old = problem.profile(z)
        target = Profile(settings.points, np.empty((len(h) * settings.points + 1, old.n)), old.period, h, old.parameter)
        return replace(target, u=old.at(target.times)).vector()

    if seed.direction is None:
        return replace(seed, problem=changed, z=moved(seed.z))
    assert seed.scale is not None
    sizes = sizes_of(seed.scale, profile.h, profile.n, profile.m)
    scale = make_scale(h, settings.points, sizes, float(seed.scale[profile.u.size]), float(seed.scale[-1]))

    def direction(d: Array | None) -> Array | None:
        if d is None:
            return None
        raw = d * seed.scale  # type: ignore[operator]
        raw[profile.u.size + 1 : -1] = profile.h
        out = moved(raw)
        out[-1 - len(h) : -1] = 0.0
        return np.asarray(out / scale)

    d, k = direction(seed.direction), direction(seed.curvature)
    assert d is not None
    norm = float(np.linalg.norm(d))
    k = None if k is None else k / elementary.square(norm)
    return replace(seed, problem=changed, z=moved(seed.z), direction=d / norm, curvature=k, scale=scale)
