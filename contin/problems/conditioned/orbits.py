"""Periodic orbits that meet conditions, by collocation: isoperiodic families, orbits of one amplitude, backbones."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.conditioned.under_conditions import Conditioned, product_of
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.hopf_end import cut_at_birth, has_shrunk, is_growing
from contin.problems.orbits.linearised.bordered import factors
from contin.problems.orbits.linearised.linear import OrbitLinear, branch_tangents
from contin.problems.orbits.linearised.multipliers import nontrivial
from contin.problems.orbits.linearised.tangent_solver import Factorised
from contin.problems.orbits.measured.functionals import OrbitConditions
from contin.problems.orbits.measured.measures import standard_names
from contin.problems.orbits.mesh.layout import Profile, make_scale, trimmed
from contin.problems.orbits.mesh.move import Move
from contin.problems.orbits.renewal import refitted
from contin.problems.tolerances import ONE_POINT

ENDLESS: Final = 1e300  # the period of an unknown that is no angle
LARGE: Final = 30.0  # times the scale of a free parameter, beyond which it is not followed
ROUNDED, UNTOLD = 1e-11, 1e-8  # errors of a multiplier 1: at least, beside ten times the trivial one's, and at most


@dataclass(frozen=True, eq=False)
class ConditionedOrbits(Conditioned):
    """u' = T f, periodicity, phase, and conditions on the orbit; unknowns u, T, q, p."""

    inner: OrbitProblem
    conditions: OrbitConditions
    reference: tuple[Array, ...] = ()  # the orbit that the phase condition refers to

    offset: tuple[float, ...] = ()  # what the conditions are to be, on the way to 0

    TESTS = ("zero", "flip", "pair")
    adaptive = True

    def profile(self, z: Array) -> Profile:
        return self.inner.profile(trimmed(self.inner_vector(trimmed(z))))

    def _bare(self, z: Array) -> Array:
        return self.inner_vector(trimmed(z))

    def _parameters(self, z: Array) -> Array:
        return np.asarray(self.at(self.free_values(z)).full_parameters(self.inner_vector(z)))

    def condition_values(self, z: Array) -> Array:
        return self.conditions.values(self.profile(z), self._parameters(z))

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Factorised | None:
        from scipy import sparse

        inner, bare, metric = self.at(self.free_values(z)), self.inner_vector(z), self.inner_vector(scale)
        known = self.reference[0] if self.reference and self.reference[0].size == bare.size else bare
        own = OrbitLinear(inner, bare, metric, known)
        if not np.all(np.isfinite(own.residual)):
            return None
        matrix = own.jacobian.tocsc()
        columns = [matrix[:, : own.nu + 1]]
        columns += [
            sparse.csc_matrix(self._column(own, k, s)[:, None])
            for k, s in zip(self.free[::-1], scale[-1 - self.k : -1], strict=True)
        ]
        values, slopes = self.conditions.linearise(own.profile, inner.full_parameters(bare))
        rows, sizes = [], []
        for one in slopes:
            by_parameters = one.p[[*self.free[::-1], self.inner.active]]
            row = np.concatenate([one.u.ravel(), [one.period], by_parameters]) * scale[self._unknowns(z)]
            size = float(np.linalg.norm(row))
            rows.append(row / size if size > 0.0 else row)
            sizes.append(size or 1.0)
        top = sparse.hstack([*columns, matrix[:, -1:]])
        values = values - np.array(self.offset) if self.offset else values
        equations = np.append(own.residual, values / np.array(sizes))
        where = self._unknowns(z)
        whole = sparse.vstack([top, sparse.csc_matrix(np.array(rows)), tangent[where][None, :]], format="csc")
        if not np.all(np.isfinite(equations)):
            return None
        try:
            return Factorised(equations, factors(whole), where, z.size)
        except np.linalg.LinAlgError:  # singular: the corrector fails there
            return None

    def _unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, T, q, p) in z."""
        return np.concatenate([np.arange(self.profile(z).u.size + 1), np.arange(z.size - 1 - self.k, z.size)])

    def _column(self, own: OrbitLinear, k: int, scale: float) -> Array:
        """The scaled derivative of the orbit's equations by parameter k."""
        name = self.system.parameter_names[k]
        z = np.append(own.z[:-1], own.problem.base[k])
        return OrbitLinear(own.problem.with_active(name, own.z), z, own.scale, own.reference).by_parameter * scale

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        inner = self.at(self.free_values(z))
        values = np.asarray(inner.multipliers(self.inner_vector(z)))
        others = nontrivial(inner, values)
        if not np.all(np.isfinite(others)):
            return np.full(3, np.nan), 0, values
        beyond = others - 1.0
        trivial = abs(complex(values[0]) - 1.0) if self.inner.autonomous else 0.0
        critical = (np.abs(beyond) <= min(ROUNDED + 10.0 * trivial, UNTOLD)) & (beyond.imag == 0.0)
        beyond = np.where(critical, UNTOLD, beyond)  # on a continuum of orbits it is rounding, other at each row
        pairs = np.array([a * b - 1.0 for i, a in enumerate(others) for b in others[i + 1 :]])
        tests = np.array([product_of(beyond), product_of(others + 1.0), product_of(pairs)])
        return tests, int(np.sum((np.abs(others) > 1.0) & ~critical)), values

    def inner_type(self, test: str, near: Sample, also: Collection[str]) -> str | None:
        if test == "zero":
            return "LPC" if not also else "BPC"
        if test == "flip":
            return "PD"
        others = nontrivial(self.inner, near.eigenvalues)
        return "NS" if np.any(np.abs(others.imag) > 0.0) else None

    def near_inner(self, near: Sample, z: Array, frame: Frame, place: int) -> tuple[Sample, Frame]:
        inner, bare, metric = self._unfolded(z, frame.scale, place)
        tangent = branch_tangents(inner, bare, metric)[0]
        return Sample(bare, tangent, np.full(4, np.nan), near.unstable, inner.multipliers(bare)), Frame(metric)

    def shifted(self, offset: Array, z: Array) -> ConditionedOrbits:
        return replace(self, offset=tuple(offset.tolist()), reference=(self.inner_vector(z),))

    def finer(self, near: Sample, frame: Frame) -> tuple[Conditioned, Sample, Frame] | None:
        profile = self.profile(near.z)
        return self._moved(near, frame, np.repeat(profile.h / 2.0, 2))

    def _moved(self, near: Sample, frame: Frame, h: Array) -> tuple[ConditionedOrbits, Sample, Frame]:
        metric = self.inner_vector(frame.scale)
        sizes = self.inner.sizes(self.inner_vector(near.z), metric)
        period = float(metric[self.profile(near.z).u.size])
        there = make_scale(h, self.inner.points, sizes, period, float(metric[-1]))
        scale = self.joined(there, self.free_values(frame.scale))
        moved = self._sample_moved(near, frame.scale, scale, h)
        return replace(self, reference=(self.inner_vector(moved.z),)), moved, Frame(scale)

    def _sample_moved(self, sample: Sample, old: Array, scale: Array, h: Array) -> Sample:
        move = Move(self.inner, self.inner_vector(old), self.inner_vector(scale), h)
        bare = replace(sample, z=self.inner_vector(sample.z), tangent=self.inner_vector(sample.tangent))
        share = float(np.linalg.norm(bare.tangent))
        there = move(bare)
        t = self.joined(share * there.tangent, self.free_values(sample.tangent))
        return replace(sample, z=self.joined(there.z, self.free_values(sample.z)), tangent=t / np.linalg.norm(t))

    # -- the engine's contract -----------------------------------------------------------------------------------------

    def configured(self, seed: Seed, settings: Settings) -> Seed:
        """On the mesh that is asked for, and on the conditions."""
        bare = Seed(self.inner, self.inner_vector(seed.z))
        chosen = self.inner.configured(bare, settings)
        if not isinstance(chosen.problem, OrbitProblem):
            raise InputError("conditions on orbits need collocation (smooth equations, no `method: shooting`)")
        problem = replace(self, inner=chosen.problem, reference=(chosen.z,))
        z = self.joined(chosen.z, self.free_values(seed.z))
        scale = problem.initial_scale(z, (-np.inf, np.inf))
        found = problem.onto_conditions(z, scale)
        if found is None:
            names, texts = ", ".join(self.free_names), ", ".join(r.text for r in self.conditions.relations)
            raise InputError(
                f"no orbit near the start meets the conditions ({texts}) for any nearby {names}: they are off by "
                f"{', '.join(f'{v:.3g}' for v in problem.condition_values(z))} there; start nearer to them"
            )
        return replace(seed, problem=replace(problem, reference=(self.inner_vector(found),)), z=found)

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        free = self.free_values(z)
        metric = self.at(free).initial_scale(self.inner_vector(z), bounds)
        return self.joined(metric, self.free_widths(z, self.profile(z).u[:: self.inner.points]))

    def march_periods(self, z: Array) -> Array:
        periods = np.full(z.size - 1, ENDLESS)
        periods[: self.profile(z).u.size] = 0.0
        return periods

    def _has_shrunk(self, origin: Sample, before: Sample | None, scale: Array) -> bool:
        """True at a Hopf point, where the branch does not just come from there."""
        shrunk = self.inner.autonomous and has_shrunk(self, origin.z, scale)
        return shrunk and not is_growing(self, before, origin, scale)

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        """Mesh and sizes for the next chunk, or the Hopf point to which the orbit has shrunk."""
        if self._has_shrunk(origin, before, frame.scale):
            text = f"the orbit shrank to a Hopf point near {self.parameters[0]} = {origin.z[-1]:.4g}"
            return Renewal(frame.scale, origin, before, None, End("hopf", text))
        free, widths = self.free_values(origin.z), self.free_values(frame.scale)
        for name, value, width in zip(self.free_names, free, widths, strict=True):
            if abs(value) > LARGE * width:
                text = f"{name} has grown to {value:.6g}, {LARGE:g} times its scale: it may grow without bound"
                return Renewal(frame.scale, origin, before, None, End("bound", f"{text} (or declare its scale)"))
        inner, metric = self.at(free), self.inner_vector(frame.scale)
        profile, bare = self.profile(origin.z), self.inner_vector(origin.z)
        fit = refitted(inner, profile, inner.sizes(bare, metric), float(metric[profile.u.size]))
        if fit is None:
            return Renewal(frame.scale, origin, before, loop)
        metric = make_scale(fit.h, profile.m, fit.sizes, fit.period, float(metric[-1]))
        scale = self.joined(metric, self.free_values(frame.scale))

        def moved(sample: Sample | None) -> Sample | None:
            return None if sample is None else self._sample_moved(sample, frame.scale, scale, fit.h)

        here = self._sample_moved(origin, frame.scale, scale, fit.h)
        return Renewal(scale, here, moved(before), moved(loop))

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        near = np.abs(a.z[-1 - self.k :] - b.z[-1 - self.k :]) <= ONE_POINT * scale[-1 - self.k :]
        return bool(np.all(near)) and bool(self.inner.same_point(
            replace(a, z=self.inner_vector(a.z)), replace(b, z=self.inner_vector(b.z)), self.inner_vector(scale)
        ))  # fmt: skip

    def columns(self, z: Array) -> dict[str, Array]:
        """As of orbits, with the free parameters and the functionals in conditions."""
        rows: list[dict[str, float]] = []
        for row in z:
            point = trimmed(row)
            inner, bare = self.at(self.free_values(point)), self.inner_vector(point)
            found = {name: float(column[0]) for name, column in inner.columns(bare[None]).items()}
            found |= dict(zip(self.free_names, self.free_values(point).tolist(), strict=True))
            numbers = self.conditions.numbers(self.profile(point), inner.full_parameters(bare))
            rows.append(found | {name: numbers[name] for name in self.conditions.functionals})
        return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives."""
        inner = self.inner
        names = [*inner.system.state_names, *inner.system.observable_names]
        parts = [f"{name}.{end}" for name in names for end in ("min", "max")]
        asked = () if inner.measures is None else inner.measures.texts
        own = ("period", *parts, *standard_names(inner.system), *asked)
        return tuple(dict.fromkeys((inner.parameters[0], *self.free_names, *own, *self.conditions.functionals)))

    @property
    def winding(self) -> Array:
        """What each state gains in one period."""
        return np.asarray(self.inner.winding)

    def orbit_sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric of z."""
        return self.inner.sizes(self.inner_vector(z), self.inner_vector(scale))

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = super().march(origin, before, length, frame, step, limit, bounds, settings, loop)
        return cut_at_birth(self, chunk, frame, settings) if self.inner.autonomous else chunk

    def describe_failure(self, z: Array) -> str:
        return str(self.at(self.free_values(z)).describe_failure(self.inner_vector(z)))
