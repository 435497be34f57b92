"""Curves of special points in two parameters as equilibria of an extended model (`symbolic.passes.loci`), compiled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, cast
from weakref import WeakKeyDictionary

import numpy as np

from contin.abi import Array
from contin.loci.equilibria.across import first_across, usual_rate
from contin.loci.tolerances import FORCED
from contin.lowering import compile_system
from contin.machine import elementary
from contin.problems.gauged import Gauged
from contin.symbolic.passes import loci

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

PLANE = 0.3  # sine of the angle below which the border says too little about the second vector of the critical plane
VECTOR = 2.0  # how much a turn of a null vector counts in the metric: 1 / VECTOR of its angle
ORTHOGONAL = 1e-7

_systems: WeakKeyDictionary[Any, dict[tuple[str, ...], Any]] = WeakKeyDictionary()


def extended_system(system: CompiledSystem, type_: str, first: str, second: str) -> CompiledSystem:
    """The compiled defining system of a type's curve, made once per model and second parameter."""
    passes: dict[str, Callable[[], Any]] = {
        "LP": lambda: loci.fold_system(system.computable, second),
        "PD": lambda: loci.flip_system(system.computable, second),
        "HB": lambda: loci.hopf_system(system.computable, second),
        "NS": lambda: loci.hopf_system(system.computable, second),
        "BP": lambda: loci.branch_point_system(system.computable, first, second),
    }
    known: dict[tuple[str, ...], CompiledSystem] = _systems.setdefault(system, {})
    key = (type_, first, second) if type_ == "BP" else (type_, second)
    if key not in known:
        known[key] = compile_system(passes[type_](), regular=True)
    return known[key]


@dataclass(frozen=True, eq=False)
class Gauge:
    """The border (HB, NS) or the direction across the curve (BP): kept as long as it serves."""

    values: Array | None = None
    rows: tuple[float, float] = (1.0, 1.0)  # factors of the rows `symbolic.passes.loci.ROWS`


@dataclass(frozen=True, eq=False)
class ExtendedCurve(Gauged):
    """z = (u, null vectors, [kappa or unfolding], second parameter, first parameter); N - 1 equations.

    system : the model's own.  base (m,) : all its parameters.  sizes (n,) : typical sizes of its states.
    """

    type: str
    system: CompiledSystem
    base: Array
    first: int
    second: int
    sizes: Array
    gauge: Gauge | None = None

    compiled = True  # the kernel can march it

    @cached_property
    def extended(self) -> Any:
        names = self.system.parameter_names
        return extended_system(self.system, self.type, names[self.first], names[self.second])

    @property
    def places(self) -> tuple[int, ...]:
        """Of the varying parameters, in the order of the unknowns."""
        return self.second, self.first

    @cached_property
    def n(self) -> int:
        return int(self.system.n)

    @cached_property
    def size(self) -> int:
        """N, the number of unknowns."""
        return int(self.extended.n) + 1

    @property
    def has_scalar(self) -> bool:
        """True where kappa or the unfolding parameter is an unknown (third from the end)."""
        return self.type in ("HB", "NS", "BP")

    @cached_property
    def active(self) -> int:
        """Place of the first parameter among those of the extended system."""
        return list(self.extended.parameter_names).index(self.system.parameter_names[self.first])

    @cached_property
    def _template(self) -> Array:
        """Parameters of the extended system with the sizes, without border and first parameter."""
        values = np.ones(self.extended.m)
        kept = len(self.base) - 1
        values[: self.second], values[self.second : kept] = self.base[: self.second], self.base[self.second + 1 :]
        first = kept + len(loci.ROWS)
        values[first : first + self.n] = self.sizes
        return values

    # -- reading z ----------------------------------------------------------------------------------------------------

    def full_parameters(self, z: Array) -> Array:
        """All parameters of the model at z."""
        p = self.base.copy()
        p[self.first], p[self.second] = z[-1], z[-2]
        return p

    def scalar(self, z: Array) -> float:
        """kappa, or the unfolding parameter."""
        return float(z[-3])

    def vector(self, z: Array) -> Array:
        """v (LP, HB, PD, NS) or w (BP), in the states' units."""
        return np.asarray(z[self.n : 2 * self.n])

    def left_vector(self, z: Array) -> Array:
        """w of a branch point."""
        return self.vector(z)

    def matrix(self, z: Array) -> Array:
        """f_u, unscaled."""
        return np.asarray(self.system.jacobian(z[: self.n], self.full_parameters(z))[1][:, : self.n])

    # -- the equations ------------------------------------------------------------------------------------------------

    def parameters(self, z: Array, gauge: Any = None) -> Array:
        """Parameters of the extended system for work near z, whose own vector belongs to them."""
        known = cast(Gauge, gauge) if gauge is not None else self.gauge or Gauge()
        values = self._template.copy()
        rows = len(self.base) - 1
        values[rows : rows + len(loci.ROWS)] = known.rows
        border = self._border(z, known)
        if border is not None:
            values[len(values) - len(border) :] = border
        values[self.active] = z[-1]
        return values

    def linearise(self, z: Array, parameters: Array | None = None) -> tuple[Array, Array]:
        """F (N - 1,) and its Jacobian (N - 1, N), unscaled."""
        p = self.parameters(z) if parameters is None else parameters.copy()
        p[self.active] = z[-1]
        f, jacobian = self.extended.jacobian(z[:-1], p)
        k = self.size - 1
        chosen = np.empty((k, k + 1))
        chosen[:, :k], chosen[:, k] = jacobian[:, :k], jacobian[:, k + self.active]
        return f, chosen

    def values(self, z: Array, parameters: Array) -> Array:
        """F at rows z, (rows, N - 1), unscaled."""
        p = np.repeat(parameters[None], len(z), axis=0)
        p[:, self.active] = z[:, -1]
        return np.asarray(self.extended.jacobians(z[:, :-1], p)[0])

    def _border(self, z: Array, known: Gauge) -> Array | None:
        if self.type in ("LP", "PD"):
            return None
        if self.type == "BP":
            return self._first_across(z) if known.values is None else known.values
        return self._serving(z, known.values) * self.sizes

    def _serving(self, z: Array, border: Array | None) -> Array:
        """A border while z's v is normal to it, else another one."""
        v = self.vector(z) / self.sizes
        if border is not None and abs(float(border @ v)) / float(np.linalg.norm(border)) < ORTHOGONAL * self.n:
            return border
        return self._normal(z)

    def _beside(self, z: Array, v: Array) -> Array:
        """The critical plane (n, 2) without its part along v."""
        plane = critical_plane(self.squared(self.matrix(z) * self.sizes / self.sizes[:, None], self.scalar(z)))
        return np.asarray(plane - np.outer(v, v @ plane))

    def _normal(self, z: Array) -> Array:
        """The border that is the second direction of the critical plane, normal to z's v."""
        v = self.vector(z) / self.sizes
        rest = self._beside(z, v / np.linalg.norm(v))
        border = rest[:, int(np.argmax(np.linalg.norm(rest, axis=0)))]
        return np.asarray(border / np.linalg.norm(border))

    def settled(self, z: Array, scale: Array) -> Self:
        """The same curve at the start of a chunk: with another border where it has turned out of the critical plane."""
        known = Gauge(rows=self._rows(z, scale)) if self.gauge is None else self.gauge
        if self.type == "BP":
            across = replace(self, gauge=known)._across(z)
            return replace(self, gauge=known if across is None else replace(known, values=across))
        if self.type not in ("HB", "NS"):
            return replace(self, gauge=known)
        border = self._serving(z, known.values)
        if float(np.linalg.norm(border @ self._beside(z, self.vector(z) / self.sizes))) < PLANE:
            border = self._normal(z)
        return replace(self, gauge=known if border is known.values else replace(known, values=border))

    def turns_from(self, other: Self) -> bool:
        """True where the border is another one: v turns in that plane differently, and so does the tangent."""
        if self.type not in ("HB", "NS") or self.gauge is None or other.gauge is None:
            return False
        return self.gauge.values is not other.gauge.values

    def _rows(self, z: Array, scale: Array) -> tuple[float, float]:
        """What makes rows of rates as large as the others."""
        rate = float(np.linalg.norm(self.matrix(z) * self.sizes / self.sizes[:, None]))
        if self.type == "BP" or not 0.0 < rate < np.inf:
            return 1.0, 1.0
        return rate * float(scale[-2]), rate * (float(scale[-3]) if self.type == "HB" else 1.0)

    def _across(self, z: Array) -> Array | None:
        """On a forced curve of branch points: the direction across it, in which the products with w vanish best."""
        _, jacobian = self.linearise(z)
        largest = np.abs(jacobian).max(axis=1, keepdims=True)  # 0 of an equation that vanishes to second order
        along = np.linalg.svd(jacobian / np.where(largest > 0.0, largest, 1.0))[2][-1]
        width = elementary.hypot(along[-1], along[-2])
        return np.array([-along[-2], along[-1]]) / width if width > 0.0 and self._is_forced(z) else None

    def _first_across(self, z: Array) -> Array:
        places = self.first, self.second
        return first_across(self.system, z[: self.n], self.full_parameters(z), places, self.sizes, 0.0)

    def _is_forced(self, z: Array) -> bool:
        """True where the unfolding, a rate in these units of w, is nothing beside the rates of the equations."""
        return abs(self.scalar(z)) < FORCED * self._rate(z)

    def _rate(self, z: Array) -> float:
        """In which the unfolding of branch points is measured."""
        found = usual_rate(self.system, z[: self.n], self.full_parameters(z), self.sizes)
        return found if 0.0 < found < np.inf else 1.0

    def squared(self, matrix: Array, kappa: float) -> Array:
        if self.type == "HB":
            return matrix @ matrix + kappa * np.eye(self.n)
        return matrix @ matrix - 2.0 * kappa * matrix + np.eye(self.n)

    def turned(self, z: Array) -> tuple[ExtendedCurve, Array]:
        """For work next to a Bogdanov-Takens point: this curve with a border of its own, and z with another v.

        There the plane of v holds a null vector of f_u. Were v that vector, no parameter would change f_u^2 v along the
        left null vector, and the system would be singular: v is taken where f_u v is largest.
        """
        if self.type != "HB":
            return self, z
        scaled = self.matrix(z) * self.sizes / self.sizes[:, None]
        plane = critical_plane(self.squared(scaled, self.scalar(z)))
        v = plane @ np.linalg.svd(scaled @ plane)[2][0]
        rows = (self.gauge or Gauge()).rows
        turned = self.with_vector(z, scaled, v)
        return replace(self, gauge=Gauge(self._normal(turned), rows)), turned

    def turned_back(self, z: Array, like: Array) -> Array:
        """z with the v of its critical plane that is nearest to that of `like`."""
        if self.type != "HB":
            return z
        scaled = self.matrix(z) * self.sizes / self.sizes[:, None]
        plane = critical_plane(self.squared(scaled, self.scalar(z)))
        v = plane @ (plane.T @ (self.vector(like) / self.sizes))
        return self.with_vector(z, scaled, v / np.linalg.norm(v))

    def with_vector(self, z: Array, scaled: Array, v: Array) -> Array:
        out = z.copy()
        out[self.n : 2 * self.n], out[2 * self.n : 3 * self.n] = v * self.sizes, (scaled @ v) * self.sizes
        return out

    # -- setting out --------------------------------------------------------------------------------------------------

    def place(self, u: Array, p: Array, scalar: float = 0.0) -> Array:
        """z at a point of the curve (u, p), its vectors computed; `scalar` is kappa (HB: omega^2, NS: cos theta)."""
        system, d = self.system, self.sizes
        matrix = np.asarray(system.jacobian(u, p)[1][:, : self.n])
        scaled = matrix * d / d[:, None]
        ends = np.array([p[self.second], p[self.first]])
        if self.type in ("LP", "PD"):
            shift = {"LP": 1.0 if system.kind == "map" else 0.0, "PD": -1.0}[self.type]
            v = np.linalg.svd(scaled - shift * np.eye(self.n))[2][-1]
            return np.concatenate([u, _oriented(v) * d, ends])
        if self.type == "BP":
            shift = 1.0 if system.kind == "map" else 0.0
            w = np.linalg.svd((scaled - shift * np.eye(self.n)).T)[2][-1]
            return np.concatenate([u, _oriented(w) / d, [0.0], ends])
        v = _oriented(critical_plane(self.squared(scaled, scalar))[:, 0])
        return np.concatenate([u, v * d, (scaled @ v) * d, [scalar], ends])

    def scales(self, z: Array, widths: tuple[float, float]) -> Array:
        """The metric: states by their sizes, vectors by a multiple of those.

        Parameters by the widths of their ranges.
        """
        d = self.sizes
        ends = np.array([widths[1], widths[0]])
        if self.type in ("LP", "PD"):
            return np.concatenate([d, VECTOR * d, ends])
        if self.type == "BP":
            return np.concatenate([d, VECTOR / d, [self._rate(z)], ends])
        kappa = 1.0 if self.type == "NS" else self._frequency_squared(z)
        return np.concatenate([d, VECTOR * d, VECTOR * np.sqrt(kappa) * d, [kappa], ends])

    def _frequency_squared(self, z: Array) -> float:
        """A typical size of kappa: its own, or that of the slowest other eigenvalue where it vanishes (at BT)."""
        matrix = self.matrix(z) * self.sizes / self.sizes[:, None]
        values = np.sort(np.abs(np.linalg.eigvals(matrix)))
        typical = elementary.square(float(values[2] if self.n > 2 else np.abs(matrix).max()))
        return max(abs(self.scalar(z)), 0.1 * typical) or 1.0

    @cached_property
    def identifying(self) -> Array:
        """True for states, kappa and both parameters."""
        mask = np.zeros(self.size, bool)
        mask[: self.n] = True
        mask[-3 if self.has_scalar else -2 :] = True
        return mask

    @cached_property
    def growing(self) -> Array:
        """True for states and kappa, and of Hopf points for w = f_u v, which grows as the rates do."""
        mask = self.identifying.copy()
        mask[-2:] = False
        if self.type == "HB":
            mask[2 * self.n : 3 * self.n] = True
        return mask


def critical_plane(matrix: Array) -> Array:
    """Orthonormal basis (n, 2) of the right singular vectors of the two smallest singular values."""
    return np.asarray(np.linalg.svd(matrix)[2][-1:-3:-1].T)


def _oriented(v: Array) -> Array:
    return np.asarray(v * np.sign(v[int(np.argmax(np.abs(v)))]))
