"""What orbits connect and manifolds leave: a cycle with its Floquet modes, or an equilibrium, at fixed parameters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import InputError
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

STEPS: Final = 2000  # of the variational equations over a period
STRONGEST: Final = 28.0  # |log| of a multiplier whose mode is resolved
NEUTRAL: Final = 1e-3  # |log| of a multiplier, within which it counts as 1


@dataclass(frozen=True, eq=False)
class Rest:
    """An equilibrium at p; the rates of its directions, fastest outwards last."""

    system: CompiledSystem
    p: Array
    u: Array

    @cached_property
    def matrix(self) -> Array:
        return np.asarray(self.system.jacobian(self.u, self.p)[1][:, : self.system.n])

    def dimension(self, unstable: bool) -> int:
        rates = np.linalg.eigvals(self.matrix).real
        return int(np.sum(rates > 0.0)) if unstable else int(np.sum(rates < 0.0))

    def basis(self, unstable: bool, units: Array) -> Array:
        """Basis (n, k) of the unstable (stable) eigenspace, orthonormal in the units of the states."""
        values, vectors = np.linalg.eig(self.matrix * units / units[:, None])
        chosen = values.real > 0.0 if unstable else values.real < 0.0
        columns = vectors[:, chosen]
        left, _, _ = np.linalg.svd(np.hstack([columns.real, columns.imag]), full_matrices=False)
        return np.asarray(left[:, : int(chosen.sum())] * units[:, None])


@dataclass(frozen=True, eq=False)
class Cycle:
    """A periodic orbit at p, with its variational equation."""

    system: CompiledSystem
    p: Array
    profile: Profile

    @property
    def period(self) -> float:
        return float(self.profile.period)

    @cached_property
    def times(self) -> Array:
        """Scaled times at which it is sampled, (STEPS + 1,)."""
        return np.linspace(0.0, 1.0, STEPS + 1)

    @cached_property
    def states(self) -> Array:
        return self.profile.at(self.times)

    @cached_property
    def fundamental(self) -> Array:
        """Fundamental matrices Phi(t), (STEPS + 1, n, n), by the classical Runge-Kutta method."""
        n, h = self.system.n, 1.0 / STEPS
        fine = self.profile.at(np.linspace(0.0, 1.0, 2 * STEPS + 1))
        whole = self.system.jacobians(np.ascontiguousarray(fine), np.tile(self.p, (len(fine), 1)))[1]
        a = self.period * np.asarray(whole)[:, :, :n]
        found = np.empty((STEPS + 1, n, n))
        found[0] = np.eye(n)
        for k in range(STEPS):
            x, first, middle, last = found[k], a[2 * k], a[2 * k + 1], a[2 * k + 2]
            k1 = first @ x
            k2 = middle @ (x + 0.5 * h * k1)
            k3 = middle @ (x + 0.5 * h * k2)
            found[k + 1] = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + last @ (x + h * k3))
        return found

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """All but the trivial one."""
        values = np.linalg.eigvals(self.fundamental[-1]).astype(complex)
        return np.delete(values, int(np.argmin(np.abs(values - 1.0))))

    def outside(self, unstable: bool) -> list[float]:
        """The real multipliers outside (inside) the unit circle; InputError where one is complex or neutral."""
        chosen = []
        for value in self.multipliers:
            size = _logarithm(value)
            if abs(size) < NEUTRAL:
                raise InputError(f"a multiplier of the cycle, {value:.6g}, is neutral: it has no hyperbolic manifolds")
            if (size > 0.0) is unstable:
                chosen.append(_real(value))
        return chosen

    def strongest(self, unstable: bool) -> float:
        """The real multiplier farthest outside (inside) the unit circle; InputError where there is none."""
        sign = 1.0 if unstable else -1.0
        value = max(self.multipliers, key=lambda m: sign * _logarithm(m), default=1.0 + 0j)
        if sign * _logarithm(value) < NEUTRAL:
            raise InputError(f"the cycle has no {'unstable' if unstable else 'stable'} multiplier besides 1")
        return _real(value)

    def adjoint(self, multiplier: float, times: Array, units: Array) -> Array:
        """w(t) of w' = -A^T w + sigma w with |units w(0)| = 1, at scaled times, (len(times), n)."""
        values, vectors = np.linalg.eig(self.fundamental[-1].T)
        w = np.real(vectors[:, int(np.argmin(np.abs(values - multiplier)))])
        sigma = float(elementary.log(abs(multiplier)))
        right = np.broadcast_to(w, (STEPS + 1, len(w)))[..., None]
        at = np.linalg.solve(self.fundamental.transpose(0, 2, 1), right)[..., 0]
        at = at * elementary.exp(sigma * self.times)[:, None]
        return self._read(at / np.linalg.norm(units * w), times)

    def direction(self, multiplier: float, times: Array) -> Array:
        """v(t) = exp(-sigma t) Phi(t) v, the direct mode, at scaled times."""
        values, vectors = np.linalg.eig(self.fundamental[-1])
        v = np.real(vectors[:, int(np.argmin(np.abs(values - multiplier)))])
        sigma = float(elementary.log(abs(multiplier)))
        at = np.einsum("kij,j->ki", self.fundamental, v) * elementary.exp(-sigma * self.times)[:, None]
        return self._read(at / np.linalg.norm(v), times)

    def _read(self, values: Array, times: Array) -> Array:
        return np.stack([np.interp(times, self.times, column) for column in values.T], axis=1)

    def nearest(self, state: Array, phase: float, units: Array) -> float:
        """The phase near a given one at which the offset of a state is normal to the cycle, in the states' units."""
        for _ in range(20):
            u = self.profile.at(np.array([phase % 1.0]))[0]
            f = self.period * np.asarray(self.system.value(u, self.p)) / units
            step = float(f @ ((state - u) / units)) / float(f @ f)
            phase += float(np.clip(step, -0.05, 0.05))
            if abs(step) < 1e-12:
                break
        return phase % 1.0

    def shifted(self, phase: float) -> Cycle:
        """The same cycle that begins at another scaled time."""
        times = self.profile.times
        u = self.profile.at((phase + times) % 1.0)
        u[-1] = u[0]
        fresh = Profile(self.profile.m, u, self.profile.period, self.profile.h, self.profile.parameter)
        return Cycle(self.system, self.p, fresh)


def _logarithm(multiplier: complex) -> float:
    return float(elementary.log(max(abs(multiplier), 1e-300)))


def _real(multiplier: complex) -> float:
    """A multiplier whose mode is resolved and real."""
    if abs(_logarithm(multiplier)) > STRONGEST:
        raise InputError(f"a multiplier of the cycle, {multiplier:.3g}, is so strong that rounding hides its mode")
    if abs(multiplier.imag) > 1e-9 * abs(multiplier):
        raise InputError(
            f"the cycle has complex multipliers ({multiplier:.6g}), whose adjoint modes would be projected out: "
            "only real ones are"
        )
    return float(multiplier.real)
