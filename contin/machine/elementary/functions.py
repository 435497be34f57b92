"""The elementary functions for Python: numbers give numbers, arrays give arrays.

As in C, and unlike in `math`, nothing is raised: log(-1) is NaN, exp(1000) infinite. Few values are computed by the
interpreter, which does the same operations (about 10 us each); a function is compiled, in 30 ms, when many are wanted.
One that is there already, because a kernel needed it, is called (1 us each). The bits are the same.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contin.abi import Array
from contin.machine.elementary.code import addresses, is_loaded, loop_address, source
from contin.machine.elementary.names import symbol

Complex = NDArray[np.complexfloating[Any, Any]]
T = TypeVar("T")

FEW: Final = 1000  # values: their time in the interpreter is less than that of a compilation
SHORT: Final = 20  # values of an array: so many calls of the function take less time than loading its loop


@cache
def _scalar(name: str, arguments: int) -> Callable[..., float]:
    return ctypes.CFUNCTYPE(ctypes.c_double, *[ctypes.c_double] * arguments)(addresses([name])[symbol(name)])


@cache
def _loop(name: str, arguments: int) -> Callable[..., None]:
    return ctypes.CFUNCTYPE(None, ctypes.c_int64, *[ctypes.c_void_p] * (arguments + 1))(loop_address(name))


_computed: dict[str, int] = {}  # values of each function that the interpreter computed


def _interpreted(name: str, count: int) -> bool:
    """Whether to compute this many more values without a loop in machine code."""
    _computed[name] = _computed.get(name, 0) + count
    return _computed[name] <= FEW


def _apply(name: str, *x: Any) -> Any:
    if type(x[0]) is float and type(x[-1]) is float and is_loaded(name):  # mostly, of numbers
        return _scalar(name, len(x))(*x)
    if all(isinstance(v, (float, int)) for v in x):
        if is_loaded(name) or not _interpreted(name, 1):
            value = _scalar(name, len(x))(*x)
        else:
            value = source(name)(*map(float, x))
        return np.float64(value) if any(isinstance(v, np.generic) for v in x) else value
    arrays = _alike(x)
    given = [np.ascontiguousarray(a, dtype=np.float64) for a in arrays]
    out = np.empty(arrays[0].shape)
    loaded = is_loaded(name)
    if (loaded and out.size <= SHORT) or _interpreted(name, out.size):
        function = _scalar(name, len(x)) if loaded else source(name)
        out[...] = np.reshape([function(*v) for v in zip(*(a.ravel().tolist() for a in given), strict=True)], out.shape)
        return out if out.ndim else np.float64(out)
    _loop(name, len(x))(out.size, *(a.ctypes.data for a in given), out.ctypes.data)
    return out if out.ndim else np.float64(out)


def _alike(x: tuple[Any, ...]) -> Sequence[Any]:
    """The arguments as arrays of one shape."""
    if isinstance(x[0], np.ndarray) and all(isinstance(v, (float, int)) for v in x[1:]):  # mostly; and much faster
        return [x[0], *(np.full(x[0].shape, float(v)) for v in x[1:])]
    return np.broadcast_arrays(*x)


class _OfOne:
    """A function of one real variable."""

    def __init__(self, name: str) -> None:
        self.__name__ = name

    @overload
    def __call__(self, x: float) -> float: ...
    @overload
    def __call__(self, x: Array) -> Array: ...
    @overload
    def __call__(self, x: ArrayLike) -> Any: ...
    def __call__(self, x: object) -> Any:
        return _apply(self.__name__, x)


class _OfTwo:
    """A function of two real variables."""

    def __init__(self, name: str) -> None:
        self.__name__ = name

    @overload
    def __call__(self, x: float, y: float) -> float: ...
    @overload
    def __call__(self, x: Array, y: float | Array) -> Array: ...
    @overload
    def __call__(self, x: ArrayLike, y: ArrayLike) -> Any: ...
    def __call__(self, x: object, y: object) -> Any:
        return _apply(self.__name__, x, y)


exp2, expm1 = _OfOne("exp2"), _OfOne("expm1")
log, log1p, log10, log2 = _OfOne("log"), _OfOne("log1p"), _OfOne("log10"), _OfOne("log2")
sin, cos, tan = _OfOne("sin"), _OfOne("cos"), _OfOne("tan")
asin, acos, atan = _OfOne("asin"), _OfOne("acos"), _OfOne("atan")
sinh, cosh, tanh = _OfOne("sinh"), _OfOne("cosh"), _OfOne("tanh")
asinh, acosh, atanh = _OfOne("asinh"), _OfOne("acosh"), _OfOne("atanh")
pow, atan2, hypot = _OfTwo("pow"), _OfTwo("atan2"), _OfTwo("hypot")


@overload
def exp(x: float) -> float: ...
@overload
def exp(x: complex) -> complex: ...
@overload
def exp(x: Array) -> Array: ...
@overload
def exp(x: Complex) -> NDArray[np.complex128]: ...
def exp(x: Any) -> Any:
    """e^x, of real and of complex x."""
    if not np.iscomplexobj(x):
        return _apply("exp", x)
    size, turn = _apply("exp", np.real(x)), np.imag(x)
    real, imaginary = size * _apply("cos", turn), size * _apply("sin", turn)
    if isinstance(x, np.ndarray):
        out = np.empty(x.shape, dtype=np.complex128)
        out.real, out.imag = real, imaginary
        return out
    return np.complex128(real, imaginary) if isinstance(x, np.generic) else complex(real, imaginary)


@overload
def angle(z: complex) -> float: ...
@overload
def angle(z: Complex) -> Array: ...
def angle(z: Any) -> Any:
    """Argument of z, in [-pi, pi]."""
    return _apply("atan2", np.imag(z), np.real(z))


def square(x: T) -> T:
    """x x, rounded once; `x**2` of a number is the C library's pow."""
    return x * x  # type: ignore[operator,no-any-return]
