"""A user's function with all its derivatives: what a compiled system is to a model, without machine code."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contin.abi import NO_FUNCTION, Array
from contin.errors import InputError, NotFiniteError
from contin.normalforms.jet import expand_complex
from contin.problems.functions.derivatives import Lines, is_analytic

if TYPE_CHECKING:
    from contin.problems.functions.problem import FunctionProblem


class FunctionSystem:
    """Values and derivatives of a `FunctionProblem` in vectors u (n,), p (m,); z = (u, p).

    The same methods as a compiled system has; its addresses are `NO_FUNCTION`. Jacobians are dense here.
    """

    jacobian_address = NO_FUNCTION
    is_forced = False
    n_switches = 0

    def __init__(self, model: FunctionProblem) -> None:
        self.model = model
        self.kind = model.kind
        self.n, self.m = model.n, len(model.parameter_names)
        self.state_names, self.parameter_names = model.state_names, model.parameter_names
        u0, p0 = model.start_point()
        value = self.value(u0, p0)
        if model.jacobian is not None:
            self._check_jacobian(u0, p0)
        if not np.all(np.isfinite(value)):
            raise NotFiniteError(f"{self.explain(u0, p0)} (at u0)")
        recorded: Mapping[str, float] = {} if model.record is None else model.record(u0, self._named(p0))
        self.observable_names = tuple(recorded)
        taken = sorted(set(self.observable_names) & {*self.state_names, *self.parameter_names, "stable", "unstable"})
        if taken:
            raise InputError(f"record: the names {', '.join(taken)} are taken; choose others")

    def _check_jacobian(self, u0: Array, p0: Array) -> None:
        assert self.model.jacobian is not None
        shape = np.shape(self.model.jacobian(u0, self._named(p0)))
        if shape != (self.n, self.n):
            raise InputError(f"jacobian must return dF/du of shape ({self.n}, {self.n}); got {shape}")

    def _named(self, p: NDArray[Any]) -> dict[str, Any]:
        return dict(zip(self.parameter_names, p.tolist(), strict=True))

    # values ---------------------------------------------------------------------------------------------------------

    def raw(self, u: NDArray[Any], p: NDArray[Any]) -> NDArray[Any]:
        """F(u, p) (n,), real or complex, as the user's function gives it."""
        value = np.asarray(self.model.residual(u, self._named(p)))
        if value.shape != (self.n,):
            raise InputError(f"the residual must return {self.n} numbers, one for each state; got shape {value.shape}")
        return value

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        """F(u, p), (n,)."""
        with np.errstate(all="ignore"):
            return np.array(self.raw(np.array(u, dtype=float), np.asarray(p, dtype=float)), dtype=float)

    def observables(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Recorded values at N points, (N, k)."""
        rows_u = np.atleast_2d(np.asarray(u, dtype=float))
        rows_p = np.broadcast_to(np.asarray(p, dtype=float), (len(rows_u), self.m))
        out = np.empty((len(rows_u), len(self.observable_names)))
        if self.model.record is not None:
            for k, (row_u, row_p) in enumerate(zip(rows_u, rows_p, strict=True)):
                recorded = self.model.record(row_u, self._named(row_p))
                out[k] = [float(recorded[name]) for name in self.observable_names]
        return out

    def symmetry(self, name: str, u: ArrayLike, p: ArrayLike) -> Array:
        """Images of N states, (N, n)."""
        chosen = next(s for s in self.model.symmetries if s.name == name)
        return np.array([chosen.map(row) for row in np.atleast_2d(np.asarray(u, dtype=float))], dtype=float)

    def switches(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Functions are taken to be smooth."""
        return np.empty(0)

    def explain(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Which component is not finite at this point, or None."""
        states = np.asarray(u, dtype=float)
        bad = np.flatnonzero(~np.isfinite(self.value(states, p)))
        if not bad.size:
            return None
        where = ", ".join(f"{x:.6g}" for x in states[:6]) + (", ..." if self.n > 6 else "")
        named = ", ".join(f"{k} = {v:.10g}" for k, v in self._named(np.asarray(p, dtype=float)).items())
        return f"not finite at this point: component {bad[0]} of the residual, at u = ({where}), {named}"

    # derivatives ----------------------------------------------------------------------------------------------------

    @cached_property
    def lines(self) -> Lines:
        """Directional derivatives by complex steps or differences."""
        u0, p0 = self.model.start_point()
        states, others = np.where(u0 != 0.0, np.abs(u0), self.model.typical), np.where(p0 != 0.0, np.abs(p0), 1.0)
        sizes = np.concatenate([states, others])
        analytic = is_analytic(self.raw, u0, p0, sizes)
        return Lines(self.raw, sizes, analytic, None if analytic or self.model.jacobian is None else self._slope)

    def _slope(self, u: Array, p: Array, v: Array) -> Array:
        """D F[v] by the user's Jacobian."""
        assert self.model.jacobian is not None
        total = np.asarray(self.model.jacobian(u, self._named(p)) @ v[: self.n], dtype=float)
        for k in np.flatnonzero(v[self.n :]):
            total = total + v[self.n + k] * self.parameter_slope(u, p, int(k))
        return total

    def parameter_slope(self, u: Array, p: Array, k: int) -> Array:
        """dF/dp_k, (n,)."""
        if self.model.parameter_jacobian is not None:
            given = self.model.parameter_jacobian(u, self._named(p), self.parameter_names[k])
            return np.asarray(given, dtype=float)
        direction = np.zeros(self.n + self.m)
        direction[self.n + k] = 1.0
        lines = self.lines
        if lines.analytic:
            return lines.first(u, p, direction)
        return Lines(self.raw, lines.sizes, False).pure(u, p, direction, 1)

    def state_jacobian(self, u: Array, p: Array) -> Array:
        """dF/du, (n, n), dense."""
        if self.model.jacobian is not None:
            return np.array(self.model.jacobian(u, self._named(p)), dtype=float)
        matrix = np.empty((self.n, self.n))
        direction = np.zeros(self.n + self.m)
        for j in range(self.n):
            direction[j] = 1.0
            matrix[:, j] = self.lines.first(u, p, direction)
            direction[j] = 0.0
        return matrix

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """F (n,) and dF/dz (n, n + m)."""
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        with np.errstate(all="ignore"):
            columns = [self.parameter_slope(states, others, k) for k in range(self.m)]
            matrix = np.column_stack([self.state_jacobian(states, others), *columns])
        return self.value(states, others), matrix

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> NDArray[Any]:
        """D^k F(z)[d1, ..., dk], (n,), directions (n + m,), real or complex."""
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)

        def real(parts: tuple[Array, ...]) -> Array:
            if self.model.derivative is not None and 2 <= len(parts) <= 3:
                return np.asarray(self.model.derivative(states, self._named(others), *parts), dtype=float)
            with np.errstate(all="ignore"):
                return self.lines.form(states, others, parts)

        return expand_complex(real, tuple(np.asarray(d) for d in directions), self.n)

    def gradient(self, u: ArrayLike, p: ArrayLike, v: ArrayLike) -> NDArray[Any]:
        """The matrix D^2F(z)[v, .], (n, n + m), v real or complex."""
        direction = np.asarray(v)
        if np.iscomplexobj(direction):
            return self.gradient(u, p, direction.real) + 1j * self.gradient(u, p, direction.imag)
        states, others = np.array(u, dtype=float), np.array(p, dtype=float)
        if self.lines.analytic or self.model.jacobian is not None:
            return self.lines.along(lambda a, b: self.jacobian(a, b)[1], states, others, direction)
        unit = np.eye(self.n + self.m)
        return np.column_stack([self.derivative(u, p, direction, row) for row in unit])
