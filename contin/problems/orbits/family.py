"""What families of periodic orbits have in common, by collocation and by shooting."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.location.sameness import slack
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.continuation.together import Together
from contin.machine import elementary
from contin.problems.algebraic_states import finite_multipliers
from contin.problems.equal_multipliers import passing_together
from contin.problems.moved_along import distance_name
from contin.problems.one_parameter import InOneParameterProblem
from contin.problems.orbits.measured.columns import names_of
from contin.problems.orbits.measured.measures import Measures, standard_names
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.scales import parameter_width
from contin.problems.symmetry import symmetry_names
from contin.simulate.reach import first_to_leave, has_reach
from contin.special.table import test_on_branch
from contin.symbolic.passes.corotating import frame_generator
from contin.systems.functions.turning_frame import FunctionInFrame

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem


SAME_PERIOD = 1e-5  # relative
SAME_EXTENT = 2e-3  # relative: extents of sampled orbits are so accurate; nearby folds of one family differ by more
ROUNDED = 1e-12  # of a state's size: rounding of solutions


def alike(one: Profile, other: Profile, winding: Array, periods: Array) -> bool:
    """True for orbits of one period, one extent and one place: images under a symmetry are two.

    winding, periods (n,) : what a state gains round the orbit, and the period of an angle (0 for others). A state that
    winds has no place.
    """
    extents = np.ptp(one.u, axis=0), np.ptp(other.u, axis=0)
    gaps = [extents[0] - extents[1]]
    turn = np.where(periods == 0.0, np.inf, periods)
    for place, other_place in zip(_places(one), _places(other), strict=True):
        gap = np.where(winding == 0.0, place - other_place, 0.0)
        gaps.append(gap - np.where(periods == 0.0, 0.0, periods) * np.round(gap / turn))
    near = np.abs(gaps) <= SAME_EXTENT * np.maximum(*extents).max()
    return abs(one.period - other.period) < SAME_PERIOD * one.period and bool(np.all(near))


def _places(orbit: Profile) -> tuple[Array, Array, Array]:
    """Lowest, mean and highest values of the states, (n,) each: no phase changes them."""
    return orbit.u.min(axis=0), orbit.weights @ orbit.u, orbit.u.max(axis=0)


@dataclass(frozen=True, eq=False)
class FamilyOfOrbits(InOneParameterProblem):
    """Orbits of one compiled model in one parameter, the last unknown.

    system : the compiled model, held because kernels get addresses in it.  base : all parameter values (m_p,); entry
    `active` varies.  winding : what each state gains in one period (rotations).
    """

    system: CompiledSystem
    winding: Array

    kind = "orbit"
    adaptive = True
    locus = None

    if TYPE_CHECKING:  # a field of each family

        @property
        def measures(self) -> Measures | None:
            """Columns that are asked for beside those of every family."""

    @property
    def autonomous(self) -> bool:
        return not self.system.is_forced

    def freed(self, name: str, orbit: Array) -> tuple[Self, Array]:
        """The orbits with this parameter free (perhaps it is already), and the vector of one of them."""
        orbits = self.with_active(name, orbit)
        return orbits, np.append(orbit[:-1], orbits.base[orbits.active])

    def full_parameters(self, z: Array) -> Array:
        """All parameter values at z, and the time 0 for a forced system: (p_size,)."""
        p = np.zeros(self.system.p_size)
        p[: len(self.base)] = self.base
        p[self.active] = z[-1]
        return p

    has_shared_places = True

    def apart_at_shared_places(self, one: Array, other: Array) -> Array:
        """one - other there, less what a shift in time makes of it."""
        apart = self.at_shared_places(one, one - other)
        if not self.autonomous:
            return apart
        n = len(self.winding)
        u, period = np.split(self.at_shared_places(one, one), [n], axis=1)
        speed = period * self.system.values(u, self.full_parameters(one))
        natural = self.sizes(one, self.initial_scale(one, (float(one[-1]), float(one[-1]) + 1.0)))
        sizes = np.max(np.abs([u, u - apart[:, :n], speed]), axis=(0, 1))
        sizes = np.where(sizes > ROUNDED * natural, sizes, natural)  # a zero with rounding errors says nothing
        speed /= sizes
        length = float(np.sum(elementary.square(speed)))
        if length > 0.0:
            shift = float(np.sum(speed * apart[:, :n] / sizes)) / length
            apart[:, :n] -= shift * speed * sizes
        return apart

    @property
    def closed(self) -> bool:
        return True

    @cached_property
    def state_periods(self) -> Array:
        """Period of each state (n,), 0 where it is not an angle."""
        return np.asarray(self.system.model.periods(self.constants()), dtype=float)

    @cached_property
    def turning(self) -> Array | None:
        """Matrix (n, n) of the rotation that the model's frame follows; None where it is in none."""
        model: object = self.system.model
        if isinstance(model, FunctionInFrame):
            return model.generator_matrix
        return frame_generator(self.system.model, self.constants())

    def width(self, z: Array, bounds: tuple[float, float]) -> float:
        """Scale of the parameter: the width of its range; of an endless one, its size."""
        return parameter_width(self.system.model, self.parameters[0], float(z[-1]), bounds)

    @abstractmethod
    def profile(self, z: Array) -> Profile:
        """The orbit over one period."""

    @abstractmethod
    def sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric of z."""

    @abstractmethod
    def period_place(self, z: Array) -> int:
        """Where the period stands in z, and in its tangents."""

    @property
    @abstractmethod
    def resolution(self) -> float:
        """Relative error of the orbits: below it two of them are not told apart."""

    @abstractmethod
    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        """Multipliers of an orbit, the trivial one of an autonomous system first; NaN where they cannot be computed."""

    @abstractmethod
    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """See `contin.continuation.problem.Problem.probe`."""

    @property
    def has_reach(self) -> bool:
        return has_reach(self.system)

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """The first orbit on which the model does not hold somewhere, and why."""
        return first_to_leave(self.system, len(z), lambda row: self._states(z[row]))

    def explain_states(self, orbit: Array) -> str | None:
        """Which equation is not finite somewhere on an orbit, and why."""
        u, p = self._states(orbit)
        values, matrices = self.system.jacobians(u, p)
        finite = np.isfinite(u).all(axis=1) & np.isfinite(values).all(axis=1) & np.isfinite(matrices).all(axis=(1, 2))
        return next((text for state in u[~finite] if (text := self.system.why_not_finite(state, p[0]))), None)

    def _states(self, orbit: Array) -> tuple[Array, Array]:
        """States on an orbit, and all parameters, in rows."""
        u = self.profile(orbit).u
        return u, np.tile(self.full_parameters(orbit), (len(u), 1))

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Without the multipliers of algebraic equations."""
        return finite_multipliers(self.system, values, self.profile(z).period)

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        near = abs(float(a.z[-1] - b.z[-1])) <= slack(a, b, scale)
        return near and self.is_one(self.profile(a.z), self.profile(b.z))

    def is_one(self, one: Profile, other: Profile) -> bool:
        """True where two orbits agree in period, extent and place, whatever their phases."""
        return alike(one, other, self.winding, self.state_periods)

    def together(self, a: Sample, b: Sample) -> Iterable[Together]:
        """Where the flow is smooth; at 1 declared symmetries tell which families cross (BPC), by bordered equations."""
        if self.system.n_switches:
            return ()
        types = ("NS", "PD") if symmetry_names(self) else ("NS", "PD", "BPC")
        return passing_together(a, b, self.autonomous, types)

    def test_of(self, type_: str) -> int | None:
        return None if type_ == "flat" else test_on_branch(type_)

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives, for user values."""
        extremes = (f"{f}.{e}" for f in names_of(self.system) for e in ("min", "max"))
        moved = distance_name(self.system)
        own = (self.parameters[0], "period", *extremes, *moved, *standard_names(self.system))
        asked = () if self.measures is None else self.measures.texts
        return tuple(dict.fromkeys((*own, *asked)))
