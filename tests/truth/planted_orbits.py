"""Orbits whose bifurcations are known in closed form, in any number of states and hidden by changes of coordinates.

The unit circle of (a, b), run through once in 2 pi, carries further states with amplitude equations of their own
(untwisted, or in a plane that turns by half a turn a period). Then states with w' = -k w are added, time runs
`rate` times as fast, and the equations are written in y = h(length * Q x): Q orthogonal, h triangular and quadratic.
Rotation and added states change no coefficient, `rate` and `length` change it by known powers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude
from tests.loci.orbits.test_codim_two import CIRCLE, SQUARE, twisted

WAYS = ("plain", "rotated", "bent")
BEND = 0.1  # of the quadratic terms of h, in units of `length`

Coefficient = Callable[["Hidden"], float]


@dataclass(frozen=True)
class Planted:
    """A core of few states: label, where it is in p (and on its curve in q), and its coefficient.

    start : parameter p at which the orbit `orbit(angle, p)` (states, times) is known.
    curve : label on the curve of `type` in (p, q) and the range of q; q = q0 along the family.
    """

    name: str
    type: str
    equations: Mapping[str, str]
    start: Mapping[str, float]
    orbit: tuple[str, float] | None = None  # a further state and its constant value at the start
    radius: float = 1.0  # of the orbit at the start
    range: tuple[float, float] = (-0.3, 0.4)
    at: float = 0.0
    others: tuple[tuple[str, float], ...] = ()  # further labels along the family
    coefficient: tuple[str, Coefficient] | None = None  # nan: not known in these coordinates
    words: Mapping[str, str] = field(default_factory=dict)
    curve: tuple[str, float] | None = None
    box: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Hidden:
    """A planted core in n states."""

    core: Planted
    n: int
    way: str
    seed: int
    rate: float = 1.0
    length: float = 1.0

    def __str__(self) -> str:
        return f"{self.core.name} n={self.n} {self.way} seed={self.seed} rate={self.rate:.3g} length={self.length:.3g}"

    @cached_property
    def _random(self) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Q (n, n), decay rates (n,), bends (n,)."""
        random = np.random.default_rng(self.seed)
        turn = np.linalg.qr(random.normal(size=(self.n, self.n)))[0]
        decay = random.uniform(0.3, 1.5, self.n)
        bends = random.uniform(-BEND, BEND, self.n) if self.way == "bent" else np.zeros(self.n)
        return (np.eye(self.n) if self.way == "plain" else turn), decay, bends

    @cached_property
    def model(self) -> Model:
        turn, decay, bends = self._random
        names = list(self.core.equations)
        fields = [f"({self.rate!r})*({e})" for e in self.core.equations.values()]
        for k in range(len(names), self.n):
            names.append(f"w{k}")
            fields.append(f"({self.rate * float(decay[k])!r})*(-w{k})")
        n, length = self.n, self.length
        definitions: dict[str, str] = {}
        for k in range(n - 1, -1, -1):  # z = length Q x, y_k = z_k + bend_k z_(k+1)^2 / length
            bend = f" - ({float(bends[k]) / length!r})*z{k + 1}^2" if k < n - 1 and bends[k] else ""
            definitions[f"z{k}"] = f"y{k}{bend}"
        for i, name in enumerate(names):
            definitions[name] = _combination(turn[:, i] / length, "z")
        for i, expression in enumerate(fields):
            definitions[f"f{i}"] = expression
        equations = {}
        for k in range(n):
            definitions[f"v{k}"] = _combination(turn[k] * length, "f")
        for k in range(n):
            bend = f" + ({2.0 * float(bends[k]) / length!r})*z{k + 1}*v{k + 1}" if k < n - 1 and bends[k] else ""
            equations[f"y{k}"] = f"v{k}{bend}"
        y = self.points(np.zeros(1))[0]
        states = {f"y{k}": float(y[k]) for k in range(n)}
        return Model("planted", states=states, parameters=dict(self.core.start), definitions=definitions,
                     equations=equations)  # fmt: skip

    def points(self, angle: NDArray[Any]) -> NDArray[Any]:
        """The orbit at the start, (len(angle), n)."""
        turn, _, bends = self._random
        x = np.zeros((len(angle), self.n))
        x[:, 0], x[:, 1] = self.core.radius * np.cos(angle), self.core.radius * np.sin(angle)
        if self.core.orbit is not None:
            name, value = self.core.orbit
            x[:, list(self.core.equations).index(name)] = value
        z = self.length * x @ turn.T
        y = z.copy()
        y[:, :-1] += bends[:-1] * z[:, 1:] ** 2 / self.length
        return y

    def mean_square(self, first: str, second: str, twist: float) -> float:
        """Mean over the orbit of |Dh v|^2, v the real unit vector at `twist` times the phase in the plane of two
        states; twist = 0: of the pair (1, -i)/sqrt(2)."""
        names, angle = list(self.core.equations), 2 * pi * np.arange(512) / 512
        v = np.zeros((len(angle), self.n), complex)
        pair = (np.cos(twist * angle), np.sin(twist * angle)) if twist else (0.5**0.5, -1j * 0.5**0.5)
        v[:, names.index(first)], v[:, names.index(second)] = pair
        image = self._image(angle, v)
        return float(np.mean(np.sum(np.abs(image) ** 2, axis=1)))

    def mean_square_across(self, *radial: str) -> float:
        """Mean over the unit circle of |w|^2, w the part of Dh v with mean(<w, u0'>) = 0: v = 1 in one state, or
        (cos, sin) in two."""
        names, angle = list(self.core.equations), 2 * pi * np.arange(512) / 512
        parts = (np.cos(angle), np.sin(angle)) if len(radial) == 2 else (np.ones_like(angle),)
        v, around = np.zeros((2, len(angle), self.n))
        for name, part in zip(radial, parts, strict=True):
            v[:, names.index(name)] = part
        around[:, 0], around[:, 1] = -np.sin(angle), np.cos(angle)
        image, field = self._image(angle, v), self._image(angle, around)
        image = image - np.mean(np.sum(image * field, axis=1)) / np.mean(np.sum(field**2, axis=1)) * field
        return float(np.mean(np.sum(image**2, axis=1)))

    def _image(self, angle: NDArray[Any], v: NDArray[Any]) -> NDArray[Any]:
        """Dh v on the circle of the core's radius at its special point, 1."""
        turn, _, bends = self._random
        x = np.zeros((len(angle), self.n))
        x[:, 0], x[:, 1] = np.cos(angle), np.sin(angle)
        z, w = self.length * x @ turn.T, self.length * v @ turn.T
        image = w.copy()
        image[:, :-1] += 2.0 * bends[:-1] * z[:, 1:] * w[:, 1:] / self.length
        return image

    def family(self, **options: Any) -> Any:
        """The family in p, on which `core.at` lies."""
        period = 2 * pi / self.rate
        orbit = contin.periodic_orbit(self.model, self.points(np.linspace(0, 2 * pi, 101)), period=period)
        return contin.continuation(orbit, "p", self.core.range, **options)

    def curve(self, family: Any) -> Any:
        """The curve of the core's type in (p, q)."""
        point = next(p for p in family.points if p.type == self.core.type)
        return contin.continuation(point.locus(("p", "q")), ("p", "q"), dict(self.core.box))


def _combination(weights: Sequence[float] | NDArray[Any], prefix: str) -> str:
    terms = [f"({float(w)!r})*{prefix}{k}" for k, w in enumerate(weights) if w != 0.0]
    return " + ".join(terms) or "0"


def cubic(factor: float, first: str = "c", second: str = "d", twist: float = 0.5) -> Coefficient:
    """A coefficient of x^3 whose eigenfunction v is e(twist phi) in the plane of two states (twist = 1/2: a turning
    plane), which for a pair is (1, -i)/sqrt(2) up to a turn: time is 1/rate, and the mean of |v|^2 is to be 1."""
    return lambda hidden: factor * hidden.rate / hidden.mean_square(first, second, twist)


def _torus(growth: str, turn: str, first: str = "c", second: str = "d") -> dict[str, str]:
    return dict(zip((first, second), amplitude(first, second, growth, turn), strict=True))


_R2 = "(c^2 + d^2)"
_BOX = {"p": (-0.3, 0.4), "q": (-0.5, 0.7)}
_FOLD = {"start": {"p": 0.25, "q": -0.3}, "orbit": ("x", 0.5), "range": (-0.5, 0.5)}
_FOLD_BOX = {"p": (-0.5, 0.5), "q": (-0.3, 0.4)}
_GROWTH = "((p) - ((a^2 + b^2) - 1)^2)"

SIMPLE = (
    Planted(  # r' = r (p - S^2), theta' = 1 + S, S = r^2 - 1: b = 2 s0 w0 / w1 = 2 in slow time
        "LPC, period changing", "LPC",
        {"a": f"{_GROWTH}*a - (a^2 + b^2)*b", "b": f"{_GROWTH}*b + (a^2 + b^2)*a"},
        {"p": 0.25}, radius=1.5**0.5, range=(-0.3, 0.4), coefficient=("b", lambda h: 2.0 * h.rate),
    ),
    Planted(  # r' = -4 (r - 1)^2
        "LPC, period constant", "LPC",
        {"a": f"{_GROWTH}*a - b", "b": f"{_GROWTH}*b + a"},
        {"p": 0.25}, radius=1.5**0.5, range=(-0.3, 0.4),
        coefficient=("b", lambda h: 4.0 * h.rate / h.mean_square_across("a", "b") ** 0.5),
    ),
    Planted(
        "LPC, beside a circle", "LPC", {**CIRCLE, "x": "p - x^2"}, {"p": 0.25}, orbit=("x", 0.5), range=(-0.3, 0.4),
        coefficient=("b", lambda h: h.rate / h.mean_square_across("x") ** 0.5),
    ),
    Planted(
        "BPC, pitchfork", "BPC", {**CIRCLE, "x": "x*(p - x^2)"}, {"p": -0.3}, words={"kind": "pitchfork"},
    ),
    Planted(
        "BPC, transcritical", "BPC", {**CIRCLE, "x": "x*(p - x)"}, {"p": -0.3}, words={"kind": "transcritical"},
    ),
    Planted(
        "PD, supercritical", "PD", {**CIRCLE, **twisted(f"p - {SQUARE}", "-1")}, {"p": -0.3},
        coefficient=("c", cubic(-1.0)), words={"criticality": "supercritical"},
    ),
    Planted(
        "PD, subcritical", "PD", {**CIRCLE, **twisted(f"p + 0.6*{SQUARE}", "-1")}, {"p": -0.3},
        coefficient=("c", cubic(0.6)), words={"criticality": "subcritical"},
    ),
    Planted(
        "NS, supercritical", "NS", {**CIRCLE, **_torus(f"p - {_R2}", "0.3")}, {"p": -0.3},
        coefficient=("d", cubic(-2.0, twist=0.0)), words={"criticality": "supercritical"},
    ),
    Planted(
        "NS, subcritical", "NS", {**CIRCLE, **_torus(f"p + 0.4*{_R2}", "0.3 + 0.2*" + _R2)}, {"p": -0.3},
        coefficient=("d", cubic(0.8, twist=0.0)), words={"criticality": "subcritical"},
    ),
)  # fmt: skip

CURVES = (
    Planted(
        "CPC", "LPC", {**CIRCLE, "x": "p + q*x - x^3"}, {"p": 0.6, "q": 0.8}, ("x", 1.1626117), range=(-1.0, 1.0),
        at=2 * (0.8 / 3) ** 1.5, others=(("LPC", -2 * (0.8 / 3) ** 1.5),), curve=("CPC", 0.0),
        box={"p": (-1.0, 1.0), "q": (-0.5, 1.5)},
    ),
    Planted(
        "GPD", "PD", {**CIRCLE, **twisted(f"p + q*{SQUARE} - ({SQUARE})^2", "-1")}, {"p": -0.3, "q": -0.5},
        curve=("GPD", 0.0), box=_BOX,
    ),
    Planted(
        "CH", "NS", {**CIRCLE, **_torus(f"p + q*{_R2} - {_R2}^2", "0.3")}, {"p": -0.3, "q": -0.5},
        curve=("CH", 0.0), box=_BOX,
    ),
    Planted(
        "R1", "LPC", {**CIRCLE, "x": "y", "y": "p - x^2 + q*y + x*y"}, **_FOLD, curve=("R1", 0.0), box=_FOLD_BOX,
        others=(("NS", 0.09),),
    ),
    Planted(
        "R2", "PD", {**CIRCLE, **twisted("0", "q", along_by_z="1", across_by_s=f"p - {SQUARE}")},
        {"p": -0.2, "q": -0.35}, range=(-0.2, 0.3), curve=("R2", 0.0), box={"p": (-0.2, 0.3), "q": (-0.35, 0.3)},
    ),
    Planted(
        "R3", "NS", {**CIRCLE, **_torus(f"p - {_R2}", f"(q + 0.05*{_R2})")}, {"p": -0.3, "q": 0.28},
        curve=("R3", 1 / 3), box={"p": (-0.3, 0.4), "q": (0.28, 0.4)},
    ),
    Planted(
        "R4", "NS", {**CIRCLE, **_torus(f"p - {_R2}", f"(q + 0.05*{_R2})")}, {"p": -0.3, "q": 0.2},
        curve=("R4", 1 / 4), box={"p": (-0.3, 0.4), "q": (0.2, 0.3)},
    ),
    Planted(
        "LPPD", "LPC", {**CIRCLE, "x": "p - x^2", **twisted(f"q + 0.2*x - {SQUARE}", "-1")}, **_FOLD,
        curve=("LPPD", 0.0), box=_FOLD_BOX,
    ),
    Planted(
        "LPNS", "LPC", {**CIRCLE, "x": "p - x^2", **_torus(f"q + 0.2*x - {_R2}", "0.3")}, **_FOLD,
        curve=("LPNS", 0.0), box=_FOLD_BOX,
    ),
    Planted(
        "PDNS", "PD", {**CIRCLE, **twisted(f"p - {SQUARE}", "-1"), **_torus("p/2 + q - (e^2 + f^2)", "0.3", "e", "f")},
        {"p": -0.3, "q": -0.35}, curve=("PDNS", 0.0), box={"p": (-0.3, 0.4), "q": (-0.35, 0.3)},
    ),
    Planted(
        "NSNS", "NS", {**CIRCLE, **_torus(f"p - {_R2}", "0.3"), **_torus("p/2 + q - (e^2 + f^2)", "0.2", "e", "f")},
        {"p": -0.3, "q": -0.35}, curve=("NSNS", 0.0), box={"p": (-0.3, 0.4), "q": (-0.35, 0.3)},
    ),
)  # fmt: skip
