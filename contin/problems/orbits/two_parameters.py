"""What curves of orbits in two parameters (special periodic orbits, those of one period, connecting orbits) share."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.sample import Chunk, Frame, Sample
from contin.problems.algebraic_states import finite_multipliers
from contin.problems.gauged import Gauged
from contin.problems.orbits import hopf_end
from contin.problems.orbits.measured.columns import names_of, orbit_columns, periods, with_observables
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.tolerances import ONE_POINT
from contin.problems.two_parameters import OnAdaptiveMesh, TwoParameterProblem
from contin.simulate.reach import first_to_leave, has_reach

if TYPE_CHECKING:
    from contin.continuation.settings import Settings
    from contin.lowering.system import CompiledSystem
    from contin.problems.orbits.family import FamilyOfOrbits


class CurveOfOrbits(Gauged):
    """The equations of a curve; `orbits` gives those of the orbits, with the first parameter free."""

    orbits: FamilyOfOrbits  # an `OrbitProblem` or a `ShootingProblem`
    second: int

    @property
    def system(self) -> CompiledSystem:
        return self.orbits.system

    @property
    def base(self) -> Array:
        return np.asarray(self.orbits.base)

    @property
    def first(self) -> int:
        return int(self.orbits.active)

    def at(self, z: Array) -> Any:
        """The orbits' problem at the second parameter's value in z."""
        base = self.orbits.base.copy()
        base[self.second] = z[-2]
        return replace(self.orbits, base=base)


class CurveOfPeriodicOrbits(CurveOfOrbits):
    """z = (u at the nodes, T, h_1 .. h_N, further unknown if `extra`, q, p)."""

    @property
    def extra(self) -> int:
        """Scalar unknowns beside the orbit."""
        return 0

    def join(self, orbit: Array, q: float, further: float = 0.0) -> Array:
        """z from an orbit's own vector (u, T, h, p)."""
        return np.concatenate([orbit[:-1], [further] * self.extra, [q, orbit[-1]]])

    def orbit(self, z: Array) -> Array:
        """(u, T, h, p), also of a metric or tangent."""
        return np.concatenate((z[: -2 - self.extra], z[-1:]))

    def settled(self, z: Array, scale: Array) -> Self:
        """The curve with what fits z: borders, or the orbit that the phase condition refers to."""
        return self

    def further(self, z: Array) -> float:
        """cos(theta) or the unfolding; 0 where there is neither."""
        return float(z[-3]) if self.extra else 0.0

    def profile(self, z: Array) -> Profile:
        found: Profile = self.at(z).profile(self.orbit(z))
        return found

    def family(self, z: Array, second: bool) -> tuple[Any, Array]:
        """The family through the orbit in z, in the first parameter or the second one, and that orbit's own vector."""
        orbits, orbit = self.at(z), self.orbit(z)
        if not second:
            return orbits, orbit
        return orbits.with_active(self.system.parameter_names[self.second], orbit), np.append(orbit[:-1], z[-2])


@dataclass(frozen=True, eq=False)
class OrbitCurveProblem(OnAdaptiveMesh, TwoParameterProblem):
    """Curves of orbits: masks over their unknowns are those of `OnAdaptiveMesh`."""

    adaptive = True

    @abstractmethod
    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """See `contin.continuation.problem.Problem`."""

    @property
    def system(self) -> CompiledSystem:
        system: CompiledSystem = self.curve.system
        return system

    @property
    def angle_periods(self) -> Array:
        return np.zeros(0)

    @property
    def has_reach(self) -> bool:
        return has_reach(self.system)

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """The first orbit on which the model does not hold somewhere, and why."""
        return first_to_leave(self.system, len(z), lambda row: self._states(z[row]))

    def _states(self, point: Array) -> tuple[Array, Array]:
        """States on an orbit, and all parameters, in rows."""
        u = self.curve.profile(point).u
        p = np.zeros((len(u), self.system.p_size))
        p[:, : len(self.base)] = self.base
        p[:, self.curve.first], p[:, self.curve.second] = point[-1], point[-2]
        return u, p


class OfPeriodicOrbits(OrbitCurveProblem):
    """`curve` is a `CurveOfPeriodicOrbits`."""

    of_special_orbits = True

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        first, second = self.widths(z, bounds)
        own = self.curve.at(z).initial_scale(self.curve.orbit(z), (0.0, first))
        scale: Array = self.curve.join(own, second, 1.0)
        return scale

    def profile(self, z: Array) -> Profile:
        """The orbit of a point."""
        found: Profile = self.curve.profile(z)
        return found

    def orbit_at(self, z: Array) -> Profile:
        return self.profile(z)

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Without the multipliers of algebraic equations."""
        return finite_multipliers(self.system, values, self.profile(z).period)

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        return np.asarray(self.curve.at(z).multipliers(self.curve.orbit(z)))

    def eigenfunctions(self, z: Array, multipliers: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """(k, times, n) at the times of `profile`."""
        return np.asarray(self.curve.at(z).eigenfunctions(self.curve.orbit(z), multipliers))

    def has_shrunk(self, z: Array, scale: Array) -> bool:
        """True where the orbit is its Hopf point, but for an amplitude that does not matter."""
        return bool(self.curve.orbits.autonomous) and hopf_end.has_shrunk(self, z, scale)

    @property
    def winding(self) -> Array:
        """What each state gains in one period."""
        return np.asarray(self.curve.orbits.winding)

    def orbit_sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric of z."""
        return np.asarray(self.curve.orbits.sizes(self.curve.orbit(z), self.curve.orbit(scale)))

    def at_birth(self, origin: Sample, before: Sample | None, scale: Array) -> End | None:
        """The end of a curve whose orbits have shrunk to a Hopf point, where it does not just come from there."""
        if not self.has_shrunk(origin.z, scale) or hopf_end.is_growing(self, before, origin, scale):
            return None
        where = ", ".join(f"{k} = {v:.4g}" for k, v in zip(self.parameters, origin.z[[-1, -2]], strict=False))
        return End("hopf", f"the orbit shrank to a Hopf point near {where}")

    def columns(self, z: Array) -> dict[str, Array]:
        """Both parameters, period, and smallest and largest value over the orbit of every state and observable."""
        curve = self.curve

        def functions(u: Array, rows: Array) -> Array:
            p = np.tile(curve.at(rows[0]).full_parameters(rows[0]), (len(rows), 1))
            p[:, curve.first], p[:, curve.second] = rows[:, -1], rows[:, -2]
            return with_observables(self.system, u, p)

        columns = self.parameter_columns(z) | {"period": periods(z, curve.profile)}
        return columns | orbit_columns(z, names_of(self.system), curve.profile, functions)

    def describe_failure(self, z: Array) -> str:
        return str(self.curve.at(z).describe_failure(self.curve.orbit(z)))


class OfOnePeriod(OfPeriodicOrbits):
    """Orbits of one period, of autonomous systems; no special points are looked for."""

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = super().march(  # type: ignore[safe-super]
            origin, before, length, frame, step, limit, bounds, settings, loop
        )
        return hopf_end.cut_at_birth(self, chunk, frame, settings)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """No tests; the number of unstable multipliers, and all of them."""
        values = self.multipliers(z)
        return np.empty(0), int(np.sum(np.abs(values[1:]) > 1.0)), values

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        return bool(np.all(np.abs(a.z[[-1, -2]] - b.z[[-1, -2]]) <= ONE_POINT * scale[[-1, -2]]))
