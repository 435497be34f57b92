"""Calls of compiled functions from Python, with as little around them as ctypes allows.

Small arguments are copied into buffers that each thread owns and whose addresses are known: asking numpy for an address
takes longer than the whole copy. Shapes are checked here, because the machine code checks nothing.
"""

from __future__ import annotations

import ctypes
import itertools
import threading
from collections import deque
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import NO_FUNCTION, Address, Array
from contin.lowering.machine import MOST_POINTERS, loop_address

SEVERAL: Final = 3  # points whose Jacobians are computed in the buffers: addresses of arrays take longer
FEW: Final = 24  # points that are called one by one from Python
BUFFERED: Final = 1024  # Jacobians with more elements are written where they are returned

Call = Any
"""A compiled function, called with the addresses of its arrays; None where the system has no such function."""


@lru_cache(maxsize=64)
def _prototype(pointers: int) -> Any:
    return ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * pointers)


def make_call(address: Address, pointers: int) -> Call:
    """The function at `address`, which takes so many pointers."""
    return None if address == NO_FUNCTION else _prototype(pointers)(address)


class _Buffers(threading.local):
    """This thread's u, p, directions, a small Jacobian, and one output of each size that was asked for."""

    def __init__(self, n: int, p_size: int) -> None:
        u, p = np.zeros(n), np.zeros(p_size)
        self.outputs: dict[int, tuple[Array, int]] = {}
        self.directions: list[tuple[Array, int]] = []
        self.width = n + p_size
        self.inputs = u, p, (u.ctypes.data, p.ctypes.data, self.outputs)
        self.matrix = np.zeros((n, n + p_size)) if n * (n + p_size) <= BUFFERED else None
        self.matrix_at = self.matrix.ctypes.data if self.matrix is not None else 0

    def held(self, count: int) -> list[tuple[Array, int]]:
        """So many directions (n + p_size,) and their addresses."""
        while len(self.directions) < count:
            array = np.zeros(self.width)
            self.directions.append((array, array.ctypes.data))
        return self.directions[:count]

    def output(self, size: int) -> tuple[Array, int]:
        """An array and its address."""
        known = self.outputs.get(size)
        if known is None:
            array = np.zeros(size)
            known = self.outputs[size] = array, array.ctypes.data
        return known


class Calls:
    """Calls for a system with n states and p_size other inputs."""

    def __init__(self, n: int, p_size: int) -> None:
        self.n, self.p_size = n, p_size
        self._u_shape, self._p_shape = (n,), (p_size,)
        self._buffers = _Buffers(n, p_size)

    def vector(self, call: Call, size: int, u: ArrayLike, p: ArrayLike) -> Array:
        """(u, p, out) with an output of `size`."""
        u_at, p_at, outputs = self._load(u, p)
        out, out_at = outputs.get(size) or self._buffers.output(size)
        if call is not None:
            call(u_at, p_at, out_at)
        return out.copy()

    def jacobian(self, call: Call, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """(u, p, F, J)."""
        buffers = self._buffers
        if buffers.matrix is not None:
            value, matrix = self._linearised(call, u, p)
            return value.copy(), matrix.copy()
        u_at, p_at, _ = self._load(u, p)
        out, out_at = buffers.output(self.n)
        matrix = np.empty((self.n, self.n + self.p_size))
        call(u_at, p_at, out_at, matrix.ctypes.data)
        return out.copy(), matrix

    def _linearised(self, call: Call, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """F and a small J in this thread's buffers."""
        u_at, p_at, _ = self._load(u, p)
        buffers = self._buffers
        out, out_at = buffers.output(self.n)
        call(u_at, p_at, out_at, buffers.matrix_at)
        assert buffers.matrix is not None
        return out, buffers.matrix

    def jacobians(self, call: Call, u: Array, p: Array) -> tuple[Array, Array]:
        """(u, p, F, J) at N points u (N, n), p (N, p_size); (N, n) and (N, n, n + p_size)."""
        count = len(u)
        values, matrices = np.empty((count, self.n)), np.empty((count, self.n, self.n + self.p_size))
        if count <= SEVERAL and self._buffers.matrix is not None:
            for k in range(count):
                values[k], matrices[k] = self._linearised(call, u[k], p[k])
            return values, matrices
        states, others = (np.ascontiguousarray(a, dtype=float) for a in (u, p))
        _each(call, count, [(a.ctypes.data, a.strides[0]) for a in (states, others, values, matrices)])
        return values, matrices

    def form(self, call: Call, u: ArrayLike, p: ArrayLike, directions: Sequence[Array]) -> Array:
        """(u, p, v_1, ..., v_k, out)."""
        u_at, p_at, _ = self._load(u, p)
        held = self._buffers.held(len(directions))
        for (array, _), direction in zip(held, directions, strict=True):
            array[:] = direction
        out, out_at = self._buffers.output(self.n)
        call(u_at, p_at, *[at for _, at in held], out_at)
        return out.copy()

    def forms(self, call: Call, u: Array, p: Array, directions: Sequence[Array]) -> Array:
        """(u, p, v_1, ..., v_k, out) at N points u (N, n), p (N, p_size), v_i (N, n + p_size); out, (N, n)."""
        held = [np.ascontiguousarray(a, dtype=float) for a in (u, p, *directions)]
        out = np.empty((len(held[0]), self.n))
        if call is None or not out.size:
            return out
        _each(call, len(out), [(a.ctypes.data, a.strides[0]) for a in (*held, out)])
        return out

    def gradient(self, call: Call, u: ArrayLike, p: ArrayLike, direction: Array) -> Array:
        """(u, p, v, w, H); H."""
        u_at, p_at, _ = self._load(u, p)
        buffers = self._buffers
        ((held, held_at),) = buffers.held(1)
        held[:] = direction
        if buffers.matrix is not None:
            call(u_at, p_at, held_at, buffers.output(self.n)[1], buffers.matrix_at)
            return buffers.matrix.copy()
        matrix = np.empty((self.n, self.n + self.p_size))
        call(u_at, p_at, held_at, buffers.output(self.n)[1], matrix.ctypes.data)
        return matrix

    def gradients(self, call: Call, u: Array, p: Array, directions: Array) -> Array:
        """(u, p, v, w, H) at N points u (N, n), p (N, p_size), v (N, n + p_size); H, (N, n, n + p_size)."""
        held = [np.ascontiguousarray(a, dtype=float) for a in (u, p, directions)]
        out = np.empty((len(held[0]), self.n, self.n + self.p_size))
        if call is None or not out.size:
            return out
        places = [(a.ctypes.data, a.strides[0]) for a in (*held, out)]
        places.insert(3, (self._buffers.output(self.n)[1], 0))  # w, the same at all points
        _each(call, len(out), places)
        return out

    def vectors(self, call: Call, address: Address, size: int, u: ArrayLike, p: ArrayLike) -> Array:
        """(u, p, out) at N points, in one call; u (N, n), p (N, p_size) or (p_size,). One point gives (size,)."""
        states = np.ascontiguousarray(u, dtype=float)
        others = np.ascontiguousarray(p, dtype=float)
        if states.ndim == 1 and others.ndim == 1:
            return self.vector(call, size, states, others)
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

    def steps(self, address: Address, points: Array, p: Array) -> None:
        """(u, p, out) from points[0] (n,) on, each output the next input, into points[1:]; p (p_size,)."""
        others = np.ascontiguousarray(p, dtype=float)
        if points.shape[1:] != self._u_shape or others.shape != self._p_shape or not points.flags.c_contiguous:
            raise ValueError(
                f"points must be (N, {self.n}) in order, p ({self.p_size},); got {points.shape}, {others.shape}"
            )
        if address != NO_FUNCTION and len(points) > 1 and self.n:
            at, n = points.ctypes.data, self.n
            loop = _loop(loop_address())
            loop(address, len(points) - 1, at, n, others.ctypes.data, 0, at + points.strides[0], n)

    def _load(self, u: ArrayLike, p: ArrayLike) -> tuple[int, int, dict[int, tuple[Array, int]]]:
        """Copy u and p into this thread's buffers; their addresses, and the outputs there are."""
        states = u if type(u) is np.ndarray else np.asarray(u, dtype=float)
        others = p if type(p) is np.ndarray else np.asarray(p, dtype=float)
        if states.shape != self._u_shape:
            raise ValueError(f"u must have shape ({self.n},); got {states.shape}")
        if others.shape != self._p_shape:
            raise ValueError(f"p must have shape ({self.p_size},); got {others.shape}")
        u_buffer, p_buffer, loaded = self._buffers.inputs
        u_buffer[:] = states
        p_buffer[:] = others
        return loaded


def _each(call: Call, points: int, places: Sequence[tuple[Address, int]]) -> None:
    """Call at so many points: for each argument, its address at the first and the bytes from one point to the next."""
    if points > FEW and 4 <= len(places) <= MOST_POINTERS:
        address, words = ctypes.cast(call, ctypes.c_void_p), [word for place in places for word in place]
        _loop_over(loop_address(len(places)))(address, points, (ctypes.c_int64 * len(words))(*words))
        return
    deque(map(call, *[itertools.islice(itertools.count(at, step), points) for at, step in places]), maxlen=0)


@lru_cache(maxsize=8)
def _loop_over(address: Address) -> Any:
    return ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p)(address)


@lru_cache(maxsize=1)
def _loop(address: Address) -> Any:
    whole, pointer = ctypes.c_int64, ctypes.c_void_p
    return ctypes.CFUNCTYPE(None, pointer, whole, pointer, whole, pointer, whole, pointer, whole)(address)
