"""Calls of compiled functions from Python, with as little around them as ctypes allows.

Small arguments are copied into buffers that each thread owns and whose addresses are known: asking numpy for an address
takes longer than the whole copy. Shapes are checked here, because the machine code checks nothing.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import NO_FUNCTION, Address, Array
from contin.lowering.machine import loop_address

_prototypes = {count: ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * count) for count in range(3, 16)}


@lru_cache(maxsize=256)
def _function(address: Address, pointers: int) -> Any:
    prototype = _prototypes.get(pointers) or ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * pointers)
    return prototype(address)


class _Buffers(threading.local):
    """This thread's u, p and output."""

    def __init__(self, n: int, p_size: int) -> None:
        self.u, self.p, self.out = np.zeros(n), np.zeros(p_size), np.zeros(0)
        self.u_at, self.p_at, self.out_at = self.u.ctypes.data, self.p.ctypes.data, 0

    def output(self, size: int) -> Array:
        if self.out.size < size:
            self.out = np.zeros(size)
            self.out_at = self.out.ctypes.data
        return self.out[:size]


class Calls:
    """Calls for a system with n states and p_size other inputs."""

    def __init__(self, n: int, p_size: int) -> None:
        self.n, self.p_size = n, p_size
        self._u_shape, self._p_shape = (n,), (p_size,)
        self._buffers = _Buffers(n, p_size)

    def vector(self, address: Address, size: int, u: ArrayLike, p: ArrayLike) -> Array:
        """(u, p, out) with an output of `size`."""
        if address == NO_FUNCTION:
            return np.zeros(size)
        buffers = self._load(u, p)
        out = buffers.output(size)
        _function(address, 3)(buffers.u_at, buffers.p_at, buffers.out_at)
        return out.copy()

    def jacobian(self, address: Address, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """(u, p, F, J)."""
        buffers = self._load(u, p)
        values = buffers.output(self.n)
        matrix = np.empty((self.n, self.n + self.p_size))
        _function(address, 4)(buffers.u_at, buffers.p_at, buffers.out_at, matrix.ctypes.data)
        return values.copy(), matrix

    def form(self, address: Address, u: ArrayLike, p: ArrayLike, directions: Sequence[Array]) -> Array:
        """(u, p, v_1, ..., v_k, out)."""
        buffers = self._load(u, p)
        held = [np.ascontiguousarray(v, dtype=float) for v in directions]
        out = buffers.output(self.n)
        addresses = [v.ctypes.data for v in held]
        _function(address, 3 + len(held))(buffers.u_at, buffers.p_at, *addresses, buffers.out_at)
        return out.copy()

    def vectors(self, address: Address, size: int, u: ArrayLike, p: ArrayLike) -> Array:
        """(u, p, out) at N points, in one call; u (N, n), p (N, p_size) or (p_size,). One point gives (size,)."""
        states = np.ascontiguousarray(u, dtype=float)
        others = np.ascontiguousarray(p, dtype=float)
        if states.ndim == 1 and others.ndim == 1:
            return self.vector(address, size, states, others)
        if states.ndim != 2 or states.shape[1] != self.n:
            raise ValueError(f"u must have shape (N, {self.n}); got {states.shape}")
        count = len(states)
        if others.shape not in (self._p_shape, (count, self.p_size)):
            raise ValueError(f"p must have shape ({self.p_size},) or ({count}, {self.p_size}); got {others.shape}")
        out = np.empty((count, size))
        if address != NO_FUNCTION and count:
            steps = (self.n, self.p_size if others.ndim == 2 else 0, size)
            loop = _loop(loop_address())
            loop(address, count, states.ctypes.data, steps[0], others.ctypes.data, steps[1], out.ctypes.data, steps[2])
        return out

    def _load(self, u: ArrayLike, p: ArrayLike) -> _Buffers:
        if np.shape(u) != self._u_shape:
            raise ValueError(f"u must have shape ({self.n},); got {np.shape(u)}")
        if np.shape(p) != self._p_shape:
            raise ValueError(f"p must have shape ({self.p_size},); got {np.shape(p)}")
        buffers = self._buffers
        buffers.u[:] = u
        buffers.p[:] = p
        return buffers


@lru_cache(maxsize=1)
def _loop(address: Address) -> Any:
    whole, pointer = ctypes.c_int64, ctypes.c_void_p
    return ctypes.CFUNCTYPE(None, pointer, whole, pointer, whole, pointer, whole, pointer, whole)(address)
