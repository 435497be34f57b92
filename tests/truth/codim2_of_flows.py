"""Cores with CP, BT, GH, ZH, HH of flows: random coefficients, every event on the curve in closed form."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from tests.truth.planted_curves import Core, Event, Hidden

Random = np.random.Generator
SLACK = 1e-6  # relative, of coefficients whose error is not stated


def number(random: Random, low: float = 0.5, high: float = 1.5) -> float:
    return float(random.choice([-1.0, 1.0]) * random.uniform(low, high))


def n(value: float) -> str:
    return f"({value!r})"


def off(point: Any, key: str, exact: float, sign: bool = True) -> str:
    """A complaint, where a coefficient is farther from its value than its stated error."""
    form = point.normal_form
    if key not in form:
        return f"no {key} in {form}"
    value = float(form[key])
    value, exact = (value, exact) if sign else (abs(value), abs(exact))
    allowed = form.get("errors", {}).get(key, SLACK * abs(exact))
    away = abs(value - exact)
    return "" if away <= allowed else f"{key} = {value!r}, not {exact!r}: off by {away:.1e}, stated {allowed:.1e}"


def first(*complaints: str) -> str:
    return next((c for c in complaints if c), "")


def twins(size: float) -> Callable[[Random], list[float]]:
    return lambda random: [-size, size]


# -- one or two states ------------------------------------------------------------------------------------------------


def cusp(random: Random) -> Core:
    c = number(random)

    def check(point: Any, hidden: Hidden) -> str:
        size = np.linalg.norm(hidden.image(1.0))
        return off(point, "c", c * hidden.numbers.rate / size**2)

    return Core(
        "CP on LP", "LP", [f"A + B*w0 + {n(c)}*w0^3"], lambda s: (2 * c * s**3, -3 * c * s**2),
        [Event("CP", 0.0, check)], 0.3, lambda a, b: [c, 0.0, b, a], lambda s: s,
    )  # fmt: skip


def swallowtail(random: Random, gap: float) -> Core:
    """Two cusps at w0 = +-gap."""
    c = number(random)
    k = 6 * c * gap**2
    return Core(
        f"two CP on LP, {2 * gap:.0e} apart", "LP", [f"A + B*w0 - {n(k)}*w0^2 + {n(c)}*w0^4"],
        lambda s: (-k * s**2 + 3 * c * s**4, 2 * k * s - 4 * c * s**3), [Event("CP", -gap), Event("CP", gap)], 0.4,
        lambda a, b: [c, 0.0, -k, b, a], lambda s: s,
    )  # fmt: skip


def _takens(a: float, b: float, at: float = 0.0) -> Callable[[Any, Hidden], str]:
    def check(point: Any, hidden: Hidden) -> str:
        size, rate = np.linalg.norm(hidden.image(1.0, at=at)), hidden.numbers.rate
        sign, found = (1 if a * b > 0 else -1), point.normal_form.get("s")
        wrong = "" if found == sign or point.normal_form.get("kind") == "degenerate" else f"s = {found}, not {sign}"
        return first(
            wrong, off(point, "a", a * rate**2 / size, sign=False), off(point, "b", b * rate / size, sign=False)
        )

    return check


def takens_on_folds(random: Random) -> Core:
    a, b = number(random), number(random)
    return Core(
        "BT on LP", "LP", ["w1", f"A + B*w0 + {n(a)}*w0^2 + {n(b)}*w0*w1"], lambda s: (a * s * s, -2 * a * s),
        [Event("BT", 0.0, _takens(a, b))], 0.25, lambda p, q: [a, q, p], lambda s: s, born={"BT": ["HB"]},
    )  # fmt: skip


def takens_on_hopf(random: Random) -> Core:
    a, b = number(random), number(random)
    return Core(
        "BT on HB", "HB", ["w1", f"A + B*w0 + {n(a)}*w0^2 + {n(b)}*w0*w1"], lambda s: (0.0, s),
        [Event("BT", 0.0, _takens(a, b))], -0.4, lambda p, q: [a, q, p], born={"BT": ["LP"]},
    )  # fmt: skip


def two_takens(random: Random, gap: float) -> Core:
    a, b = number(random), number(random)
    events = [Event("BT", -gap, _takens(a, -2 * b * gap, -gap)), Event("BT", gap, _takens(a, 2 * b * gap, gap))]
    return Core(
        f"two BT on LP, {2 * gap:.0e} apart", "LP",
        ["w1", f"A + B*w0 + {n(a)}*w0^2 + {n(b)}*(w0^2 - {n(gap * gap)})*w1"], lambda s: (a * s * s, -2 * a * s),
        events, 0.25, lambda p, q: [a, q, p], lambda s: s,
    )  # fmt: skip


def cusp_beside_takens(random: Random, gap: float) -> Core:
    c, b = number(random), number(random)
    events = [Event("CP", 0.0), Event("BT", gap, _takens(3 * c * gap, b, gap))]
    return Core(
        f"CP and BT on LP, {gap:.0e} apart", "LP", ["w1", f"A + B*w0 + {n(c)}*w0^3 + {n(b)}*w1*(w0 - {n(gap)})"],
        lambda s: (2 * c * s**3, -3 * c * s**2), events, 0.35, lambda p, q: [c, 0.0, q, p], lambda s: s,
    )  # fmt: skip


# -- oscillations -----------------------------------------------------------------------------------------------------


def plane(growth: str, turn: str, first_state: int = 0) -> list[str]:
    """z' = (growth + i turn) z, z = w_k + i w_(k + 1)."""
    a, b = f"w{first_state}", f"w{first_state + 1}"
    return [f"({growth})*{a} - ({turn})*{b}", f"({growth})*{b} + ({turn})*{a}"]


def size_of(hidden: Hidden, k: int = 0) -> float:
    """|z| of a unit multiple of the eigenvector in the plane of w_k, w_(k + 1)."""
    weights = [0.0] * k + [1.0, -1.0j]
    return float(np.linalg.norm(hidden.image(*weights)) / 2.0)


R = "(w0^2 + w1^2)"


def bautin(random: Random, gap: float = 0.0) -> Core:
    l2, omega, twist = number(random), random.uniform(0.5, 2.0), number(random)

    def check(point: Any, hidden: Hidden) -> str:
        return off(point, "l2", l2 * hidden.numbers.rate / size_of(hidden) ** 4)

    cubic, ats = ("B", [0.0]) if gap == 0.0 else (f"(B^2 - {n(gap * gap)})", [-gap, gap])
    growth, turn = f"A + {cubic}*{R} + {n(l2)}*{R}^2", f"{n(omega)} + {n(twist)}*{R} + 0.1*B"
    name = "GH on HB" if gap == 0.0 else f"two GH on HB, {2 * gap:.0e} apart"
    return Core(name, "HB", plane(growth, turn), lambda s: (0.0, s), [Event("GH", s, check) for s in ats], 0.35,
                born={"GH": ["LPC"]})  # fmt: skip


class _ZeroHopf:
    """w' = A + b w^2 + s R + g w^3 + h w R, z' = (B + t w + e2 w^2 + e1 R + i (omega + nu w)) z, w = w0."""

    def __init__(self, random: Random, gap: float = 0.0) -> None:
        self.b, self.s, self.t, self.e1 = (number(random) for _ in range(4))
        self.g, self.h, self.e2 = (number(random, 0.1, 0.4) for _ in range(3))
        self.omega, self.nu = random.uniform(0.7, 2.0), number(random, 0.1, 0.4)
        r = "(w1^2 + w2^2)"
        growth = "B" if gap == 0.0 else f"(B^2 - {n(gap * gap)})"
        growth = f"{growth} + {n(self.t)}*w0 + {n(self.e2)}*w0^2 + {n(self.e1)}*{r}"
        self.equations = [
            f"A + {n(self.b)}*w0^2 + {n(self.s)}*{r} + {n(self.g)}*w0^3 + {n(self.h)}*w0*{r}",
            *plane(growth, f"{n(self.omega)} + {n(self.nu)}*w0", 1),
        ]

    def rest(self, a: float, b: float) -> list[float]:
        return [self.g, self.b, 0.0, a]

    def check(self, point: Any, hidden: Hidden) -> str:
        form = point.normal_form
        sign, theta = int(np.sign(self.b * self.s)), self.t / self.b
        bend = self.t * (2 * self.e1 / self.s - 3 * self.g / self.b + self.h / self.s)
        E = 0.5 * (2 * self.e2 + bend - 2 * self.e1 * self.b / self.s)
        E *= hidden.numbers.rate / float(np.linalg.norm(hidden.image(1.0))) ** 2
        wrong = "" if form.get("s") == sign else f"s = {form.get('s')}, not {sign}"
        return first(wrong, off(point, "theta", theta), off(point, "E", E))

    def folds(self, gap: float = 0.0) -> Core:
        ats = [0.0] if gap == 0.0 else [-gap, gap]
        name = "ZH on LP" if gap == 0.0 else f"two ZH on LP, {2 * gap:.0e} apart"
        events = [Event("ZH", s, self.check) if gap == 0.0 else Event("ZH", s) for s in ats]
        return Core(name, "LP", self.equations, lambda s: (0.0, s), events, 0.35, self.rest, born={"ZH": ["HB"]})

    def hopf(self) -> Core:
        b, g, t, e1, e2, s, h = self.b, self.g, self.t, self.e1, self.e2, self.s, self.h
        third = -2 * b / (3 * g)
        l1 = np.roots([3 * g * e1 - 2 * h * e2, 2 * b * e1 - 2 * s * e2 - h * t, -s * t])
        events = [Event("ZH", 0.0, self.check), Event("ZH", third)]
        events += [Event("GH", float(root.real)) for root in l1 if abs(root.imag) < 1e-9]
        return Core(
            "ZH on HB", "HB", self.equations, lambda w: (-b * w * w - g * w**3, -t * w - e2 * w * w), events, 0.2,
            self.rest, lambda w: w, span=(-1.5, 1.5), born={"ZH": ["LP"]},
        )  # fmt: skip


def double_hopf(random: Random, gap: float = 0.0) -> Core:
    p11, p12, p21, p22 = (number(random) for _ in range(4))
    mix, omega = number(random, 0.1, 0.5), random.uniform(0.5, 1.2)
    omega1 = omega * float(random.choice([1.53, 2.28, 3.41]))
    one, two = "(w0^2 + w1^2)", "(w2^2 + w3^2)"
    second = "B" if gap == 0.0 else f"(B^2 - {n(gap * gap)})"

    def check(point: Any, hidden: Hidden) -> str:
        rate = hidden.numbers.rate
        return first(
            off(point, "p11", p11 * rate / size_of(hidden) ** 2),
            off(point, "p22", p22 * rate / size_of(hidden, 2) ** 2),
            off(point, "theta", p12 / p22), off(point, "delta", p21 / p11),
        )  # fmt: skip

    equations = [
        *plane(f"A + {n(p11)}*{one} + {n(p12)}*{two}", f"{n(omega1)} + 0.3*{two}"),
        *plane(f"{second} + {n(mix)}*A + {n(p21)}*{one} + {n(p22)}*{two}", f"{n(omega)} - 0.2*{one}", 2),
    ]
    ats = [0.0] if gap == 0.0 else [-gap, gap]
    name = "HH on HB" if gap == 0.0 else f"two HH on HB, {2 * gap:.0e} apart"
    return Core(name, "HB", equations, lambda s: (0.0, s), [Event("HH", s, check) for s in ats], 0.35,
                born={"HH": ["HB"]})  # fmt: skip


def alone(random: Random) -> Iterator[Core]:
    """One point of each type on each curve that it lies on."""
    yield cusp(random)
    yield takens_on_folds(random)
    yield takens_on_hopf(random)
    yield bautin(random)
    yield _ZeroHopf(random).folds()
    yield _ZeroHopf(random).hopf()
    yield double_hopf(random)


def close(random: Random, gap: float) -> Iterator[Core]:
    """Two points a distance of about `gap` apart."""
    yield swallowtail(random, gap)
    yield two_takens(random, gap)
    yield cusp_beside_takens(random, gap)
    yield bautin(random, gap)
    yield _ZeroHopf(random, gap).folds(gap)
    yield double_hopf(random, gap)
