"""Arguments at which elementary functions are looked at, and their exact values by mpmath."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from typing import Any

import mpmath
import numpy as np

from contin.machine.elementary import addresses, symbol

mp = mpmath.mp.clone()
mp.prec = 250

BINARY = ("pow", "atan2", "hypot")
EXACT: dict[str, Callable[..., Any]] = {
    "exp2": lambda x: mp.mpf(2) ** x,
    "log2": lambda x: mp.log(x, 2),
    "pow": mp.power,
    "hypot": lambda x, y: mp.sqrt(x * x + y * y),
} | {
    name: getattr(mp, name)
    for name in "exp expm1 log log10 log1p sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh".split()
}


def compiled(name: str) -> Callable[..., float]:
    """The elementary function as a Python callable."""
    arguments = [ctypes.c_double] * (2 if name in BINARY else 1)
    return ctypes.CFUNCTYPE(ctypes.c_double, *arguments)(addresses([name])[symbol(name)])


def error_in_ulp(value: float, exact: Any) -> float:
    """|value - exact| in units of the last place of the exact value (of the smallest number where that is larger)."""
    if exact == 0:
        return abs(value) / math.ulp(0.0)
    exponent = max(int(mp.floor(mp.log(abs(exact), 2))), -1022)
    return float(abs(mp.mpf(value) - exact) / mp.ldexp(1, exponent - 52))


def arguments(name: str, count: int, seed: int = 0) -> list[tuple[float, ...]]:
    """Random arguments of all kinds: even in moderate ranges, log-even over all exponents, near what is special."""
    rng = np.random.default_rng(seed)

    def even(a: float, b: float) -> Any:
        return rng.uniform(a, b, count)

    def sizes(a: int, b: int) -> Any:
        return np.ldexp(rng.uniform(1, 2, count), rng.integers(a, b, count))

    def signed(x: Any) -> Any:
        return x * rng.choice([-1, 1], len(x))

    exponential = [even(-746, 709.7), even(-1, 1), signed(sizes(-60, 9)), even(-746, -707), signed(sizes(-10, -6))]
    logarithmic = [sizes(-1022, 1023), even(0.5, 2), 1 + signed(sizes(-50, -5)), sizes(-1074, -1021)]
    turns = np.arange(1, count + 1) * (math.pi / 2)
    angles = [even(-10, 10), signed(sizes(-60, 1023)), signed(sizes(0, 60)), turns, 1e3 * turns, turns / 16]
    unit = [even(-1, 1), signed(sizes(-60, -1)), 1 - sizes(-52, -2)]
    line = [even(-3, 3), signed(sizes(-60, 80))]
    growing = [even(-3, 3), even(-710, 710), signed(sizes(-60, 8)), even(-0.01, 0.01)]
    sets: dict[str, Sequence[Any]] = {
        "exp": exponential,
        "exp2": [even(-1075, 1023.9), *exponential],
        "expm1": exponential,
        **dict.fromkeys(["log", "log10", "log2"], logarithmic),
        "log1p": [0.9999 * signed(sizes(-60, 0)), sizes(-30, 1023), signed(sizes(-11, -6)), even(-1, 0)],
        **dict.fromkeys(["sin", "cos", "tan"], angles),
        **dict.fromkeys(["asin", "acos", "atanh"], unit),
        **dict.fromkeys(["atan", "asinh"], line),
        **dict.fromkeys(["sinh", "cosh", "tanh"], growing),
        "acosh": [1 + sizes(-52, 80)],
    }
    pairs: dict[str, Sequence[tuple[Any, Any]]] = {
        "pow": [
            (sizes(-1022, 1023), signed(sizes(-10, 0))),
            (even(0, 10), even(-100, 100)),
            (1 + signed(sizes(-50, -1)), signed(sizes(0, 50))),
            (sizes(-3, 3), even(-400, 400)),
            (sizes(-1074, -1000), even(-1, 1)),
        ],
        "atan2": [
            (signed(even(0, 1)), signed(even(0, 1))),
            (signed(sizes(-200, 200)), signed(sizes(-200, 200))),
            (signed(sizes(-1074, 1023)), signed(sizes(-1074, 1023))),
        ],
        "hypot": [
            (even(-1, 1), even(-1, 1)),
            (signed(sizes(-30, 30)), signed(sizes(-30, 30))),
            (sizes(1000, 1022), sizes(960, 1022)),
            (sizes(-1074, -960), sizes(-1074, -960)),
        ],
    }
    if name in BINARY:
        return [(float(x), float(y)) for xs, ys in pairs[name] for x, y in zip(xs, ys, strict=True)]
    return [(float(x),) for xs in sets[name] for x in xs]
