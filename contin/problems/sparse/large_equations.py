"""The equations of a large system: F, its bordered linearisation, eigenvalues, and what is kept of the last points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation import corrector
from contin.linalg.beside_zero import Nearest, beside_zero, by_approximation
from contin.linalg.copies import ROUNDINGS, SMALL, every, rounding_of
from contin.linalg.eigen import FEWEST, MARGIN, Spectrum
from contin.linalg.far_from_zero import WATCHED, with_far_ones
from contin.linalg.followed import followed
from contin.linalg.grown import with_grown_ones
from contin.linalg.inertia import positive_eigenvalues
from contin.linalg.linear import DirectLinear, KrylovLinear, Linear
from contin.linalg.pencil import OnRange
from contin.linalg.probed import entries
from contin.linalg.region_of_pencil import RegionOfPencil
from contin.machine import elementary
from contin.problems.one_parameter import InOneParameterProblem
from contin.problems.sparse.jacobian import JacobianSource
from contin.problems.sparse.large_linearisation import LargeLinearisation, Workspace
from contin.problems.sparse.old_factors import is_near
from contin.systems.functions.function_system import FunctionSystem

STRIDE = 2.0  # the range of the parameter has the length 1/STRIDE, ...
LONG_STRIDE = 4.0  # ... or less, where solves are iterative: cubic predictions are 1e-4 off or less over such steps
FEWEST_STABLE = 2  # eigenvalues that are followed; with fewer, the next ones are looked for again
FOLLOWED = 3  # stable eigenvalues that are followed from point to point where factors are expensive
MOST_TELLING = 10  # eigenvalues of each kind that are kept of many, ...
TELLING = 1.5  # ... beside those up to so many times the largest unstable one
WHOLE = 500  # states up to which all eigenvalues are computed where too many are near the axis for Krylov spaces
NO_NEARER = 0.7  # part of a radius that Krylov spaces have not reached from which they are not tried again
SYMMETRIC = 1e-9  # part of a matrix up to which it may be skew
UNBOUNDED = 20  # eigenvalues that are computed where nothing is known of where unstable ones are
TURNING = 0.9  # as WATCHED, of pairs where nothing but what was seen tells how far to look
OLD = 0.09  # part of an error that factors of an earlier point leave
GOOD = 0.3  # part of an error that an approximate inverse leaves from whose eigenvalues those of A are told


@dataclass(frozen=True, eq=False)
class LargeEquations(InOneParameterProblem):
    """F(u, p) = 0 with one parameter free; `base` holds all parameters, entry `active` varies."""

    system: FunctionSystem
    source: JacobianSource
    work: Workspace = field(default_factory=Workspace)
    locus = None
    kind = "equilibrium"

    @cached_property
    def angle_periods(self) -> Array:
        return self.system.model.periods()

    @cached_property
    def typical_sizes(self) -> Array:
        """Of the states and the parameter, (n + 1,)."""
        sizes = self.system.lines.sizes
        return np.append(sizes[: self.n], sizes[self.n + self.active])

    def with_active(self, name: str, z: Array | None = None) -> Self:
        return replace(super().with_active(name, z), work=Workspace())

    def effort(self) -> dict[str, int]:
        return self.source.factoriser.tally.counts()

    def residual(self, z: Array) -> Array:
        """F (n,), unscaled."""
        return self.system.value(z[:-1], self.full_parameters(z))

    def linear(self, z: Array) -> Linear | None:
        """F_u at z; None where it is not finite."""
        work = self.work
        if work.z is None or not np.array_equal(work.z, z):
            work.z, work.linear = z.copy(), self.source.at(z[:-1], self.full_parameters(z))
        return work.linear

    def precisely(self, z: Array) -> Linear | None:
        """`linear`, with factors of its own where it has some: for what is computed at one place, many times."""
        linear = self.linear(z)
        if isinstance(linear, KrylovLinear) and linear.precise is not None and not linear.near:
            self.source.forget()
            self.work.z = None
            linear = self.linear(z)
        return linear

    def parameter_slope(self, z: Array, system: FunctionSystem | None = None) -> Array:
        """F_p (n,); by default of its own system."""
        with np.errstate(all="ignore"):
            return (system or self.system).parameter_slope(z[:-1], self.full_parameters(z), self.active)

    def form(self, z: Array, *directions: Vector, system: FunctionSystem | None = None) -> Vector:
        """D^kF(z)[d1, ..., dk], k >= 2, directions (n + 1,), real or complex; by default of its own system."""
        wide = [self._among_all(d) for d in directions]
        return (system or self.system).derivative(z[: self.n], self.full_parameters(z), *wide)

    def functional(
        self, left: Callable[[Vector], Any], z: Array, v: Vector, order: int, system: FunctionSystem
    ) -> tuple[float, Array]:  # fmt: skip
        """left(D^kF(z)[v, ..., v]) of a linear functional, k = `order`, real v (n + 1,); and what it is of."""
        return system.functional_with_terms(left, z[: self.n], self.full_parameters(z), self._among_all(v), order)

    def _among_all(self, d: Vector) -> Vector:
        """A direction (n + 1,) among all parameters, (n + m,)."""
        v = np.zeros(self.n + self.system.m, d.dtype)
        v[: self.n], v[self.n + self.active] = d[: self.n], d[self.n]
        return v

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> LargeLinearisation | None:
        f = self.residual(z)
        if not np.all(np.isfinite(f)):
            return None
        linear = self.linear(z)
        slope = self.parameter_slope(z)
        if linear is None or not np.all(np.isfinite(slope)):
            return None
        row = tangent / scale
        solution = linear.bordered(slope[:, None], row[:-1, None], row[-1:, None], coarse=True)
        sign = linear.sign * (1.0 if solution.pivot > 0.0 else -1.0)
        return LargeLinearisation(f / scale[:-1], sign, scale, solution, row, self.work, z)

    def again(self, here: corrector.Linearisation, z: Array) -> LargeLinearisation | None:
        """A linearisation of this problem with the residual at another point, for one more correction."""
        assert isinstance(here, LargeLinearisation)
        f = self.residual(z)
        return replace(here, residual=f / here.scale[:-1], rough=True) if np.all(np.isfinite(f)) else None

    def spectrum(self, z: Array, at_zero: bool = False) -> Spectrum:
        """Leading eigenvalues of F_u at z, from the factors of the last point if that is near.

        at_zero : z is next to a branch point, where every copy of the eigenvalue nearest to zero is wanted.
        """
        work = self.work
        linear = work.linear
        if linear is None or work.z is None or not is_near(z[:-1], z[-1:], work.z[:-1], work.z[-1:]):
            linear = self.linear(z)
        assert linear is not None
        n = self.n
        linear = self._by_entries(linear)
        if linear.matrix is not None and n <= SMALL:
            return every(linear.matrix.toarray(), None if linear.mass is None else linear.mass.toarray())
        start = work.start if work.start is not None else np.random.default_rng(11).normal(size=n)
        radius, first, symmetric = 0.0, work.vectors is None, False
        old = None if at_zero else self._old_inverse(linear)
        if old is not None and work.vectors is not None:
            found = self._followed(linear, *old, z)
            if found is not None:
                return self._with_far_ones(linear, found)
        if linear.matrix is not None:
            right, up = self._region(linear)
            symmetric = up <= SYMMETRIC * right  # later ones come through zero, and grow out of those of the first
            radius = float(elementary.hypot(right, up)) if right > 0.0 and (first or not symmetric) else 0.0
        if linear.mass is not None and work.vectors is not None and _is_another_points(linear):
            radius = 0.0  # unstable ones grow out of those that were near the axis at an earlier point
        if n <= WHOLE and linear.matrix is not None and radius >= work.too_far:
            return self._whole(linear)
        if linear.mass is None:
            unbounded = linear.matrix is None and (first or at_zero)
        else:
            unbounded = not self._bounded(linear)
        known = 0.0 if symmetric and linear.mass is None and not first else work.reach  # see `_with_grown_ones`
        nearest = self._nearest(linear, start, radius, known, UNBOUNDED if unbounded else FEWEST, at_zero)
        found = nearest.found
        if linear.matrix is not None and not found.certain:
            if n <= WHOLE:
                if radius > 0.0:
                    work.too_far = min(work.too_far, NO_NEARER * radius)
                return self._whole(linear)
            seen = float(np.abs(found.values).max(initial=0.0))
            if seen < radius and not (symmetric and _are_all_positive(linear, found)):
                work.unseen = min(work.unseen or (seen, radius), (seen, radius))
        growing = found.values.real + nearest.shift > 0.0
        reach = float(np.abs(found.values[growing]).max(initial=0.0)) if found.certain else 0.0
        if at_zero and found.values.size:
            small = 2.0 * float(np.abs(found.values).min()) if nearest.shift == 0.0 else 2.0 * nearest.shift
            reach = max(reach, small, ROUNDINGS * rounding_of(nearest.inverse, n))
        if isinstance(nearest.inverse, OnRange):  # every vector costs solves more
            nearest = replace(nearest, found=_telling(found, reach))
        whole = nearest.with_copies(n, reach).spectrum()
        if symmetric and linear.mass is None and not first:
            whole = self._with_grown_ones(linear, nearest, whole)
        near = self._kept(whole, TURNING if linear.matrix is None else WATCHED)
        return self._with_far_ones(linear, near)

    def _followed(
        self, linear: Linear, inverse: Callable[[Array], Array], rate: float, z: Array
    ) -> Spectrum | None:  # fmt: skip
        """See `followed`; of a symmetric operator, eigenvectors next to z alone span where those of z are."""
        work, symmetric = self.work, self._is_symmetric(linear)
        assert work.vectors is not None
        near = symmetric and work.seen is not None
        near = near and is_near(z[:-1], z[-1:], work.seen[:-1], work.seen[-1:])  # type: ignore[index]
        found = followed(linear, inverse, rate, work.vectors, None, symmetric) if near else None
        if found is None:
            near = False
            found = followed(linear, inverse, rate, work.vectors, work.before, symmetric)
        if found is None or int(np.sum(found.values.real <= 0.0)) < FEWEST_STABLE:
            return None
        work.vectors, work.before = found.vectors, work.before if near else work.vectors
        work.seen, work.reach = z.copy(), _reach(found.values)
        return found

    def _with_grown_ones(self, linear: Linear, nearest: Nearest, found: Spectrum) -> Spectrum:
        """See `with_grown_ones`; where unstable ones of the last point are not followed, they are looked for."""
        work = self.work
        assert work.vectors is not None
        whole, reach = with_grown_ones(found, linear, nearest.inverse, work.vectors, work.before)
        if whole is not None:
            return whole
        start = np.asarray(work.vectors.real.sum(axis=1))
        wider = self._nearest(linear, start, 0.0, reach, FEWEST, False).with_copies(self.n, MARGIN * reach)
        if not (wider.found.certain or _are_all_positive(linear, wider.found)):
            seen = float(np.abs(found.values).max(initial=0.0)), reach
            work.unseen = min(work.unseen or seen, seen)
        return wider.spectrum()

    def _whole(self, linear: Linear) -> Spectrum:
        mass = None if linear.mass is None else linear.mass.toarray()
        return self._kept(every(linear.matrix.toarray(), mass))

    def _nearest(
        self, linear: Linear, start: Array, radius: float, known: float, fewest: int, exactly: bool
    ) -> Nearest:  # fmt: skip
        """See `beside_zero`; `by_approximation` where solves are iterative, and approximate inverses good."""
        if not exactly and linear.mass is None and isinstance(linear, KrylovLinear) and not linear.exact:
            rate = OLD if linear.precise is not None else linear.rate
            if 0.0 < rate <= GOOD:
                found = by_approximation(linear, rate, start, radius, known, fewest)
                if found is not None:
                    return found
        return beside_zero(linear, linear.weigh(start), radius, known, fewest)

    def _with_far_ones(self, linear: Linear, found: Spectrum) -> Spectrum:
        """See `with_far_ones`: where Krylov spaces of the inverse do not reach as far as unstable ones may be."""
        if linear.mass is not None or (linear.matrix is not None and self.work.unseen is None):
            return found
        return with_far_ones(found, linear.apply, self.n)

    def _by_entries(self, linear: Linear) -> Linear:
        """The same with its matrix where that costs less than what products alone leave unseen."""
        if linear.matrix is not None or self.n > WHOLE:
            return linear
        work = self.work
        if work.by_entries is None or work.by_entries[0] is not linear:
            matrix = entries(linear.apply, self.n)
            work.by_entries = linear, DirectLinear(matrix, self.source.factoriser, mass=linear.mass)
        return work.by_entries[1]

    def _kept(self, found: Spectrum, watched: float = WATCHED) -> Spectrum:
        """The same; what the next point begins with is remembered: pairs l with Re l > -watched |l| among it."""
        if found.values.size:
            work = self.work
            work.vectors, work.before = found.vectors[:, _to_follow(found.values)], work.vectors
            work.seen = None if work.z is None else work.z.copy()
            work.start = np.asarray(found.vectors.real.sum(axis=1) + found.vectors.imag.sum(axis=1))
            work.reach = _reach(found.values, watched)
        return found

    def _region(self, linear: Linear) -> tuple[float, float]:
        """See `Region.of`; infinite where nothing is known."""
        work = self.work
        if linear.mass is not None:
            work.of_pencil = work.of_pencil or RegionOfPencil(linear.mass)
            right, up = work.of_pencil.of(linear.matrix)
            return (right, up) if np.isfinite(right) else (0.0, 0.0)
        right, up = work.region.of(linear.matrix)
        if work.vectors is None and not np.isfinite(right):  # later ones grow out of those of the first point
            right, up = work.region.of_any(linear.matrix)
        return right, up

    def _is_symmetric(self, linear: Linear) -> bool:
        if linear.matrix is None or linear.mass is not None:
            return False
        right, up = self._region(linear)
        return up <= SYMMETRIC * right

    def _bounded(self, linear: Linear) -> bool:
        """Whether a part of the plane is known in which all unstable eigenvalues of the pencil are."""
        if linear.matrix is None:
            return False
        self.work.of_pencil = self.work.of_pencil or RegionOfPencil(linear.mass)
        return bool(np.isfinite(self.work.of_pencil.of(linear.matrix)[0]))

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        if self.work.unseen is not None and self.work.unseen[1] > 0.0:
            seen, radius = self.work.unseen
            return (
                f"stability is that of eigenvalues up to {seen:.3g} from zero, as many as are computed at most, and of "
                f"others that lie apart on the right; the matrix allows unstable ones up to {radius:.3g}",
            )
        if self.n <= SMALL or (self.system.model.mass_matrix is None and self.system.model.method != "matrix-free"):
            return ()
        linear = self.linear(z[-1])
        linear = linear and self._by_entries(linear)
        if linear is None or (self._bounded(linear) if linear.mass is not None else linear.matrix is not None):
            return ()
        nearest, unknown = f"{UNBOUNDED} or more eigenvalues nearest to zero", "with this mass matrix"
        if linear.mass is None:
            nearest = "eigenvalues nearest to zero, and of others that lie apart on the right"
            unknown = "of a Jacobian that is only applied"
        return (
            f"stability is that of the {nearest}: {unknown} no region is known in which all unstable ones are",
        )

    def _old_inverse(self, linear: Linear) -> tuple[Callable[[Array], Array], float] | None:
        """About A^-1 times columns, from factors or a preconditioner of an earlier point, and what part of an error it
        leaves; None where there is none."""
        if not _is_another_points(linear) or linear.mass is not None:
            return None
        assert isinstance(linear, KrylovLinear)
        if linear.precise is not None:
            return linear.precise.solve, OLD
        rate = self.source.rate()
        return None if rate is None else (lambda cs: np.column_stack([linear.precondition(r) for r in cs.T]), rate)

    def begin(self, z: Array) -> None:
        """A curve begins at z: eigenvalues are looked for there, not followed from where the last one has ended."""
        judged = self.work.judged
        if judged is None or not np.array_equal(judged[0], z):
            self.work.vectors = self.work.before = self.work.judged = None

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        judged = self.work.judged
        if judged is None or not np.array_equal(judged[0], z):
            judged = self.work.judged = z.copy(), self.spectrum(z).values
        values = judged[1]
        tests, unstable = stability_tests(values)
        return tests, unstable, values


def _are_all_positive(linear: Linear, found: Spectrum) -> bool:
    """Whether the positive ones of a symmetric matrix are all among those found."""
    count = positive_eigenvalues(linear.matrix) if linear.mass is None else None
    return count is not None and count <= int(np.sum(found.values.real > 0.0))


def _reach(values: NDArray[np.complex128], watched: float = WATCHED) -> float:
    """The largest modulus of those that are unstable or nearly so: of pairs l those with Re l > -watched |l|."""
    part = np.where(values.imag != 0.0, watched, WATCHED)
    near = values.real > -part * np.abs(values)
    return float(np.abs(values[near]).max(initial=0.0))


def _is_another_points(linear: Linear) -> bool:
    """Whether it is solved with factors, or a preconditioner, of an earlier point: every solve is dear."""
    return isinstance(linear, KrylovLinear) and not linear.fresh


def _telling(found: Spectrum, reach: float) -> Spectrum:
    """Those of many eigenvalues that say something of stability: nearest to zero, rightmost, next to the axis."""
    values = found.values
    sizes, growth = np.abs(values), -values.real
    across = np.where(values.imag != 0.0, np.abs(values.real) / np.maximum(sizes, np.finfo(float).tiny), np.inf)
    kept = (sizes <= TELLING * reach) | (values.real > 0.0)
    if len(values) > MOST_TELLING:
        for measure in (sizes, growth, across):
            kept |= measure <= np.partition(measure, MOST_TELLING)[MOST_TELLING]
        found = replace(found, values=values[kept], vectors=found.vectors[:, kept])
    return found


def _to_follow(values: NDArray[np.complex128]) -> NDArray[np.intp]:
    """Which eigenvalues are followed: those beyond the axis, however far, and some of the others next to it."""
    by_growth = np.argsort(-values.real)
    count = int(np.sum(values.real > 0.0)) + FOLLOWED
    if 0 < count < len(values) and values[by_growth[count - 1]].imag != 0.0:
        count += int(values[by_growth[count]].real == values[by_growth[count - 1]].real)  # whole pairs
    return by_growth[:count]


def stability_tests(values: NDArray[np.complex128]) -> tuple[Array, int]:
    """[pairs, 1] and the number of unstable eigenvalues; `pairs` changes sign when a complex pair crosses."""
    largest = float(np.abs(values).max(initial=1e-300))
    unstable = int(np.sum(values.real > 1e-13 * largest))
    pairs = values[values.imag > 0.0]
    if not pairs.size:
        return np.ones(2), unstable
    size = float(np.min(np.abs(pairs.real) / np.abs(pairs)))
    sign = -1.0 if int(np.sum(pairs.real > 0.0)) % 2 else 1.0
    return np.array([sign * size, 1.0]), unstable
