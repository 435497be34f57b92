"""A user's function behind addresses, so that every kernel that takes machine code takes it.

An address is that of a callback into Python with the layout of `contin.abi`. A call costs some microseconds beside what
the function itself takes. The function's failures are NaN, as everywhere in `FunctionSystem`; what Python raises beside
(Ctrl-C) cannot cross machine code, so it is kept and raised at the next call from Python.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import NO_FUNCTION, Address, Array
from contin.systems.functions.function_system import FunctionSystem

Handler = Callable[..., None]


@dataclass(frozen=True, eq=False)
class OnePiece:
    """A smooth flow taken apart at its switching surfaces: there are none (see `contin.lowering.pieces`)."""

    n: int
    p_size: int
    value_address: Address
    jacobian_address: Address
    surfaces_address: Address = NO_FUNCTION
    count: int = 0
    functions: tuple[()] = ()

    @property
    def first_mode(self) -> int:
        return self.p_size


class FunctionInKernels(FunctionSystem):
    """The same values and derivatives as `FunctionSystem`, with addresses; these are valid while the object lives."""

    constraints = None
    look_again = 64  # an orbit has some hundred points, a trajectory as many steps
    _raised: BaseException | None = None

    @cached_property
    def _value_callback(self) -> tuple[object, Address]:
        return self._callback(2, self.n, lambda u, p: super(FunctionInKernels, self).value(u, p))

    @cached_property
    def _jacobian_callback(self) -> tuple[object, Address]:
        n, width = self.n, self.n + self.m

        def call(u: int, p: int, f: int, matrix: int) -> None:
            value, slopes = _view(f, n), _view(matrix, n * width)
            value[:], slopes[:] = np.nan, np.nan
            try:
                found, full = super(FunctionInKernels, self).jacobian(_view(u, n), _view(p, self.m))
                value[:], slopes[:] = found, full.ravel()
            except BaseException as error:  # noqa: BLE001  (raised again by `_raise`)
                self._raised = error

        return _address_of(call, 4)

    @cached_property
    def _gradient_callback(self) -> tuple[object, Address]:
        n, width = self.n, self.n + self.m

        def call(u: int, p: int, v: int, along: int, out: int) -> None:
            product, matrix = _view(along, n), _view(out, n * width)
            product[:], matrix[:] = np.nan, np.nan
            try:
                states, others, direction = _view(u, n), _view(p, self.m), _view(v, width)
                product[:] = self.lines.first(states, others, direction)
                matrix[:] = np.asarray(self.gradient(states, others, direction, True), dtype=float).ravel()
            except BaseException as error:  # noqa: BLE001  (raised again by `_raise`)
                self._raised = error

        return _address_of(call, 5)

    def _callback(self, inputs: int, size: int, of: Callable[[Array, Array], Array]) -> tuple[object, Address]:
        def call(u: int, p: int, out: int) -> None:
            value = _view(out, size)
            value[:] = np.nan
            try:
                value[:] = of(_view(u, self.n), _view(p, self.m))
            except BaseException as error:  # noqa: BLE001  (raised again by `_raise`)
                self._raised = error

        return _address_of(call, inputs + 1)

    def _raise(self) -> None:
        error, self._raised = self._raised, None
        if error is not None:
            raise error

    # what kernels ask -------------------------------------------------------------------------------------------------

    @property
    def value_address(self) -> Address:
        """(u, p, F)"""
        return self._value_callback[1]

    @property
    def jacobian_address(self) -> Address:  # type: ignore[override]
        """(u, p, F, J)"""
        return self._jacobian_callback[1]

    @property
    def gradient_address(self) -> Address:
        """(u, p, v, Df[v], D^2 f[v, .])"""
        return self._gradient_callback[1]

    @cached_property
    def pieces(self) -> OnePiece:
        """The flow as trajectories are integrated."""
        return OnePiece(self.n, self.m, self.value_address, self.jacobian_address)

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        self._raise()
        return super().value(u, p)

    def values(self, u: Array, p: Array) -> Array:
        self._raise()
        return super().values(u, p)

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        self._raise()
        return super().jacobian(u, p)

    def why_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        self._raise()
        return super().why_not_finite(u, p)


def _view(address: int, size: int) -> Array:
    """The numbers at an address, not copied."""
    return np.frombuffer(memoryview((ctypes.c_double * size).from_address(address))) if size else np.empty(0)


def _address_of(call: Handler, arguments: int) -> tuple[object, Address]:
    """What must be kept while the address is used, and the address."""
    kept = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * arguments)(call)
    return kept, int(ctypes.cast(kept, ctypes.c_void_p).value or 0)
