"""Polynomial systems built backwards: a special point with chosen, exactly representable numbers, hidden by a change.

w = (u, p) is a point of F(w) = N(A (w - w0)) where N is a normal form whose special point is the origin, and A a random
integer matrix times powers of two: every coefficient is a dyadic rational, so the special point w0 is exact in binary,
in decimal, and in 50 digits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator


@dataclass(frozen=True)
class Hidden:
    """x' = equations, whose branch through the start has a point of `type` near `guess`."""

    equations: dict[str, str]
    states: dict[str, float]
    parameters: dict[str, float]
    range: tuple[float, float]
    type: str
    at: float


def unimodular(rng: Generator, n: int) -> np.ndarray:
    """A random integer matrix with determinant +-1, and so with an integer inverse."""
    m = np.eye(n, dtype=int)
    for _ in range(2 * n):
        i, j = rng.choice(n, 2, replace=False)
        m[i] += rng.integers(-1, 2) * m[j]
    return m


def inverse(m: np.ndarray) -> np.ndarray:
    found = np.rint(np.linalg.inv(m)).astype(int)
    assert (found @ m == np.eye(len(m), dtype=int)).all()
    return found


def hidden(rng: Generator, type_: str, n: int, spread: int) -> Hidden:
    """LP, BP or HB in n states at p = p0, states shifted and mixed, measured in units of 2^-spread .. 2^spread.

    y' = N(y, q), y = M diag(2^-k) (u - u0), q = p - p0:  u' = diag(2^k) M^-1 N.
    """
    p0 = float(rng.integers(-40, 41)) / 32
    u0 = rng.integers(-20, 21, n) / 8.0
    units = 2.0 ** rng.integers(-spread, spread + 1, n)
    m, back = unimodular(rng, n), None
    back = inverse(m)
    y = [
        " + ".join(f"({int(m[i, j])}*(u{j}/{float(units[j])!r} - {float(u0[j])!r}))" for j in range(n) if m[i, j])
        for i in range(n)
    ]
    y = [f"({text})" for text in y]
    q = f"(p - {p0!r})"
    c = [float(rng.integers(1, 8)) / 4 * rng.choice([-1, 1]) for _ in range(8)]
    rates = [-(1.0 + k / 2) for k in range(n)]
    normal = [f"{rates[i]}*{y[i]} + {c[i % 8]}*{y[i]}*{y[0]}" for i in range(n)]
    start = np.zeros(n)
    if type_ == "LP":  # q = y0^2 (1 + y0/16 + ..) with the others slaved
        normal[0] = f"{q} - {y[0]}^2 + {c[1] / 16}*{y[0]}^3"
        start[0] = 0.25
        q_start = start[0] ** 2 - c[1] / 16 * start[0] ** 3
    elif type_ == "BP":
        normal[0] = f"{q}*{y[0]} + {c[1]}*{y[0]}^2 + {c[2]}*{y[0]}^3 + {c[3]}*{q}^2*{y[0]}"
        q_start = -0.125
    else:
        omega = float(rng.integers(2, 9)) / 4
        r2 = f"({y[0]}^2 + {y[1]}^2)"
        growth = f"({q} + {c[2] / 4}*{q}^2 + {c[1]}*{r2})"
        normal[0] = f"{growth}*{y[0]} - ({omega} + {c[3]}*{q})*{y[1]}"
        normal[1] = f"({omega} + {c[3]}*{q})*{y[0]} + {growth}*{y[1]}"
        q_start = -0.125
    equations = {
        f"u{i}": f"{float(units[i])!r}*("
        + " + ".join(f"({int(back[i, j])})*({normal[j]})" for j in range(n) if back[i, j])
        + ")"
        for i in range(n)
    }
    u_start = units * (u0 + back @ start)
    p_start = p0 + q_start
    return Hidden(
        equations,
        {f"u{i}": float(u_start[i]) for i in range(n)},
        {"p": p_start},
        (p0 - 0.25, p0 + 0.25),
        type_,
        p0,
    )
