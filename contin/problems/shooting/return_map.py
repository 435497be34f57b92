"""Derivatives of the return map of an orbit, by differences of its Jacobian: what normal forms need.

The map takes the section of the first node to itself (a forced system: the states after a period), in coordinates y of
unit vectors in the metric of the states' sizes. Its Jacobian is made of variations with their jumps at the crossings,
so that the map has the derivatives of its smooth pieces; where two surfaces are crossed together it has none. The time
of return is one more function of y, whose gradient is the last row. Differences with steps h and, as a measure of
their error, 2 h: `jet(1)` and `jet(2)`. Cost: six Jacobians for every direction (nine more for derivatives of fourth
and fifth order), each some two trajectories over a period with n variations.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from math import factorial
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.machine import elementary
from contin.normalforms.jet import DerivativeJet
from contin.problems.no_derivatives import NoDerivatives
from contin.problems.orbits.mesh.sizes import state_sizes
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.sampling import sampled
from contin.problems.shooting.sizes import ABSOLUTE, absolute_tolerances
from contin.simulate.flight import fly

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

ACCURACY: Final = 1e-13  # of the trajectories
HIGHEST: Final = 5  # order of the derivatives
LONG_STEP: Final = 1e-2  # ... of those of fourth and fifth order: rounding ACCURACY/LONG_STEP^4
STEP: Final = 3e-3  # (scaled) of the differences, of fourth order: rounding ACCURACY/STEP^2, error STEP^4
NOISE: Final = 10.0  # trajectories' errors beside their accuracy
TOGETHER: Final = 1e-7  # of the period: crossings this close are one
LONGEST: Final = 2.0  # of the period: a trajectory beside the orbit that has not returned by then
RETURNS: Final = 8  # Newton steps for the time of return
SAMPLES: Final = 256  # of a variation over a period, ...
GAUSS: Final = 4  # ... and within parts of it


def lengths_of_steps(problem: ShotFamily, z: Array, sizes: Array) -> Array:
    """Sizes of the states (n,) for differences: those of a metric, or of the orbit where it is smaller.

    A family's metric grows with its orbits and does not shrink: what is a small step there may lead across a corner.
    """
    return np.minimum(sizes, state_sizes(problem, sampled(problem, z)))


@dataclass(frozen=True, eq=False)
class ReturnMap:
    """Of an orbit's own vector z; `sizes` of the states."""

    problem: ShotFamily
    z: Array
    sizes: Array
    _lines: dict[tuple[bytes, int], tuple[Array, ...]] = field(default_factory=dict)
    _long_lines: dict[tuple[bytes, int], tuple[Array, ...]] = field(default_factory=dict)
    _beside: dict[tuple[bytes, float], Array] = field(default_factory=dict)

    @cached_property
    def nodes(self) -> Nodes:
        return Nodes.of(self.z, self.problem.n)

    @cached_property
    def basis(self) -> Array:
        """Columns: directions of the section, orthonormal in scaled states; all directions for a forced system."""
        if not self.problem.autonomous:
            return np.eye(self.problem.n)
        from scipy.linalg import null_space

        return np.asarray(null_space((self.nodes.normal * self.sizes)[None]))

    def _fly(self, u: Array, duration: float, **more: Any) -> Any:
        if not 0.0 < duration < LONGEST * self.nodes.period:
            raise NoDerivatives("a trajectory beside the orbit does not return")
        problem, p = self.problem, self.problem.full_parameters(self.z)
        beside = ABSOLUTE * ACCURACY * STEP * self.sizes  # states that are zero on the orbit are not beside it
        atol = np.maximum(absolute_tolerances(problem, self.nodes, p, ACCURACY), beside)
        flight = fly(problem.system, u, p, duration, rtol=ACCURACY, atol=atol, budget=problem.budget, **more)
        if flight.outcome != "done" or flight.touched:
            raise NoDerivatives("a trajectory beside the orbit does not return")
        return flight

    def _slope(self, u: Array) -> Array:
        return np.asarray(self.problem.system.value(u, self.problem.full_parameters(self.z)))

    def jacobian(self, y: Array) -> Array:
        """dP at y in the coordinates, and as a last row the gradient of the time of return."""
        problem, nodes, n = self.problem, self.nodes, self.problem.n
        u, time = nodes.u[0] + self.sizes * (self.basis @ y), nodes.period
        flight = self._fly(u, time, variations=np.eye(n))
        if problem.autonomous:
            for _ in range(RETURNS):
                end = flight.end[:n]
                f = self._slope(end)
                step = (float(nodes.normal @ (end - problem.winding)) - nodes.offset) / float(nodes.normal @ f)
                if abs(step) <= 1e-14 * nodes.period:
                    break
                time -= step
                flight = self._fly(u, time, variations=np.eye(n))
            f = self._slope(flight.end[:n])
            rate = float(nodes.normal @ f)
            through = np.eye(n) - np.outer(f, nodes.normal) / rate
            times = -(nodes.normal @ flight.variations) * self.sizes / rate
        else:
            through, times = np.eye(n), np.zeros(n)
        scaled = (through @ flight.variations) * self.sizes / self.sizes[:, None]
        return np.vstack([self.basis.T @ scaled, times]) @ self.basis

    def _at(self, direction: Array, k: int, step: float = STEP) -> Array:
        key = direction.tobytes(), k * step
        if key not in self._beside:
            self._beside[key] = self.jacobian(k * step * direction)
        return self._beside[key]

    def _line(self, direction: Array, factor: int) -> tuple[Array, ...]:
        """First and second derivative of `jacobian` along a unit direction, by steps of `factor` STEP."""
        key = direction.tobytes(), factor
        if key not in self._lines:
            g = {k: self._at(direction, factor * k) for k in (-2, -1, 1, 2)}
            h = factor * STEP
            first = (8.0 * (g[1] - g[-1]) - (g[2] - g[-2])) / (12.0 * h)
            second = (16.0 * (g[1] + g[-1]) - (g[2] + g[-2]) - 30.0 * self._centre) / (12.0 * elementary.square(h))
            self._lines[key] = first, second
        return self._lines[key]

    @cached_property
    def _centre(self) -> Array:
        return self.jacobian(np.zeros(self.basis.shape[1]))

    def _long_line(self, direction: Array, factor: int) -> tuple[Array, ...]:
        """Third and fourth derivative of `jacobian` along a unit direction, by steps of `factor` LONG_STEP."""
        key = direction.tobytes(), factor
        if key not in self._long_lines:
            h = factor * LONG_STEP
            odd, even = {}, {}
            for k in (1, 2, 3):
                ahead, behind = (self._at(direction, factor * sign * k, LONG_STEP) for sign in (1, -1))
                odd[k], even[k] = ahead - behind, ahead + behind
            third = (8.0 * odd[2] - odd[3] - 13.0 * odd[1]) / (8.0 * elementary.pow(h, 3))
            fourth = (12.0 * even[2] - even[3] - 39.0 * even[1] + 56.0 * self._centre) / (6.0 * elementary.pow(h, 4))
            self._long_lines[key] = third, fourth
        return self._long_lines[key]

    def _derivative(self, directions: tuple[Array, ...], factor: int) -> Array:
        """D^k (P, time of return) along real directions, 2 <= k <= `HIGHEST`."""
        if not all(np.any(d) for d in directions):
            return np.zeros(len(directions[0]) + 1)
        if len(directions) == 2:
            known = {line for line, _ in self._lines}
            along, other = sorted(directions, key=lambda d: (d / np.linalg.norm(d)).tobytes() not in known)
            return np.asarray(self._bend((along,), factor) @ other)  # symmetric: along a line that is known
        often = [sum(np.array_equal(d, e) for e in directions) for d in directions]
        last = int(np.argmin(often))
        return np.asarray(self._bend((*directions[:last], *directions[last + 1 :]), factor) @ directions[last])

    def _bend(self, directions: tuple[Array, ...], factor: int) -> Array:
        """The derivative of `jacobian` along so many directions, from those along single lines (polarisation)."""
        first, *rest = directions
        order = len(directions)
        if all(np.array_equal(d, first) for d in rest):
            return self._straight(first, order, factor)
        total = np.zeros_like(self._centre)
        for signs in product((1.0, -1.0), repeat=order - 1):
            along = first + sum(sign * d for sign, d in zip(signs, rest, strict=True))
            total = total + float(np.prod(signs)) * self._straight(along, order, factor)
        return total / (2.0 ** (order - 1) * factorial(order))

    def _straight(self, direction: Array, order: int, factor: int) -> Array:
        """The derivative of `jacobian` of an order along a direction of any length."""
        size = float(np.linalg.norm(direction))
        if size == 0.0:
            return np.zeros_like(self._centre)
        unit = direction / size
        if unit[int(np.argmax(np.abs(unit)))] < 0.0:
            unit, size = -unit, -size
        found = self._line(unit, factor)[order - 1] if order < 3 else self._long_line(unit, factor)[order - 3]
        return np.asarray(found * elementary.pow(size, order))

    def slope_of_time(self, direction: Vector) -> complex:
        """Derivative of the time of return."""
        return complex(self._centre[-1] @ direction)

    def bend_of_time(self, q: Vector, factor: int = 1) -> float:
        """D^2 of the time of return along q and its conjugate."""
        parts = [part for part in (np.real(q), np.imag(q)) if np.any(part)]
        return float(sum(self._derivative((part, part), factor)[-1] for part in parts))

    @property
    def noise(self) -> float:
        """Rounding errors of third derivatives, in the coordinates."""
        return self.noise_of(3)

    def noise_of(self, order: int) -> float:
        """Rounding errors of derivatives of an order, in the coordinates."""
        step = STEP if order <= 3 else LONG_STEP
        return NOISE * ACCURACY / elementary.pow(step, order - 1) * float(np.abs(self._centre).max())

    def jet(self, factor: int = 1) -> DerivativeJet:
        """The derivatives as a normal form wants them; raises `NoDerivatives`."""
        times = self._fly(self.nodes.u[0], self.nodes.period).crossings[:, 0]
        if np.any(np.diff(times) < TOGETHER * self.nodes.period):
            raise NoDerivatives("surfaces are crossed together: the return map is only piecewise smooth")
        sizes = np.ones(self.basis.shape[1])  # of coordinates that are scaled; balancing would amplify rounding

        def derivative(directions: tuple[Array, ...]) -> Array:
            return self._derivative(directions, factor)[:-1]

        return DerivativeJet(self._centre[:-1], derivative, kind="map", scale=sizes)

    def unit(self, q: Array) -> float:
        """The square of what q (coordinates) must be multiplied with for its variation to have the mean square 1 over
        the period in the model's units."""
        return 1.0 / self._mean_square(self._eigenvector(self.sizes * (self.basis @ q)))

    def unit_without_drift(self, q: Array) -> float:
        """`unit` at a fold across which the period does not change: of the variation with mean(<v, u0'>) = 0."""
        return 1.0 / self._mean_square(self.sizes * (self.basis @ q), across=self.problem.autonomous)

    def _eigenvector(self, v: Vector) -> Any:
        """The eigenvector of the monodromy matrix whose projection onto the section is v."""
        if not self.problem.autonomous:
            return v
        f = self._slope(self.nodes.u[0])
        matrix = self._fly(self.nodes.u[0], self.nodes.period, variations=np.eye(self.problem.n)).variations
        image = matrix @ v
        value = complex(np.vdot(v, image - f * (self.nodes.normal @ image) / (self.nodes.normal @ f)) / np.vdot(v, v))
        share = (self.nodes.normal @ image) / (self.nodes.normal @ f)
        return v + f * share / (value - 1.0)

    def _mean_square(self, v: Vector, across: bool = False) -> float:
        """Of the variation that begins with v, over a period; of its part `across` the orbit."""
        times, weights = self._quadrature
        parts = np.column_stack([v.real, v.imag])
        flight, n = self._fly(self.nodes.u[0], self.nodes.period, variations=parts, times=times), self.problem.n
        samples = flight.samples
        mean = float(weights @ np.sum(elementary.square(samples[:, n:]), axis=1))
        if across:
            field = np.array([self._slope(u) for u in samples[:, :n]])
            along = float(weights @ np.sum(field * samples[:, n : 2 * n], axis=1))
            mean -= elementary.square(along) / float(weights @ np.sum(elementary.square(field), axis=1))
        return mean

    @cached_property
    def _quadrature(self) -> tuple[Array, Array]:
        """Times of a period and weights of a mean over it: equally far apart, where all is smooth and periodic (the
        error falls faster than any power); by Gauss's rule between crossings of surfaces, where variations jump."""
        period = self.nodes.period
        if not self.problem.system.n_switches:
            return (np.arange(SAMPLES) + 0.5) / SAMPLES * period, np.full(SAMPLES, 1.0 / SAMPLES)
        crossed = self._fly(self.nodes.u[0], period).crossings[:, 0]
        ends = np.unique(np.concatenate([[0.0, period], crossed[(crossed > 0.0) & (crossed < period)]]))
        counts = np.ceil(np.diff(ends) / period * (SAMPLES // GAUSS)).astype(int)
        edges = np.concatenate([np.linspace(a, b, k + 1)[:-1] for a, b, k in zip(ends, ends[1:], counts, strict=False)])
        lengths = np.diff(np.append(edges, period))
        points, weights = np.polynomial.legendre.leggauss(GAUSS)
        times = edges[:, None] + lengths[:, None] * (0.5 + 0.5 * points)
        return times.ravel(), np.outer(lengths, 0.5 * weights).ravel() / period
