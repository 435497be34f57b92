"""Points of codimension two that are known in closed form, in smooth coordinates that hide them.

A core of few states w has a curve of folds, Hopf points, ... in its unfolding parameters A and B that is known as a
whole: s -> (A, B), with every point of codimension two on it. Beside it stand states w_k' = r_k w_k (maps: m_k w_k),
some of them unstable. Then y = T(w), T triangular with quadratic and cubic terms, x = M y with cond M given, time runs
`rate` times as fast, and A, B are affine in p and q.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from mpmath import mp
from numpy.typing import NDArray

import contin
from contin.model.model import Model

Array = NDArray[Any]
BEND = 0.3  # of the quadratic and cubic terms of T, in units of the core
EDGE = 0.02  # of the box: an event this near to it is not planted
BOX = {"p": (-1.0, 1.0), "q": (-1.0, 1.0)}


@dataclass(frozen=True)
class Event:
    """A point of codimension two at s = `at`; `check` gets the point and its hidden system, and returns a complaint."""

    type: str
    at: float
    check: Callable[[Any, Hidden], str] = lambda point, hidden: ""


@dataclass(frozen=True)
class Core:
    """Equations of w0, w1, ... in A and B; the curve of `type` in them, the events on it, and where to begin.

    rest : the polynomial in w0 (highest power first) whose roots are the equilibria at A, B; None where w = 0 is one.
    begin : s of the point of the curve that is found first.  span : values of s between which all events are listed.
    """

    name: str
    type: str
    equations: Sequence[str]
    curve: Callable[[float], tuple[float, float]]
    events: Sequence[Event]
    begin: float
    rest: Callable[[float, float], Sequence[float]] | None = None
    state: Callable[[float], float] = lambda s: 0.0  # w0 on the curve
    span: tuple[float, float] = (-2.0, 2.0)
    kind: str = "flow"
    born: Mapping[str, Sequence[str]] = field(default_factory=dict)  # by type of event: the other curves through it


@dataclass(frozen=True)
class Hidden:
    """A core in n states."""

    core: Core
    n: int
    condition: float
    seed: int

    def __str__(self) -> str:
        return f"n={self.n} condition={self.condition:.0e} seed={self.seed}"

    @cached_property
    def numbers(self) -> Numbers:
        return Numbers.drawn(self)

    @cached_property
    def model(self) -> Model:
        core, x, n = self.core, self.numbers, self.n
        inverse = np.linalg.inv(x.matrix)
        definitions: dict[str, str] = {
            "A": f"{_n(x.slopes[0, 0])}*(p - {_n(x.at[0])}) + {_n(x.slopes[0, 1])}*(q - {_n(x.at[1])})",
            "B": f"{_n(x.slopes[1, 0])}*(p - {_n(x.at[0])}) + {_n(x.slopes[1, 1])}*(q - {_n(x.at[1])})",
        }
        for k in range(n - 1, -1, -1):
            y = _sum(inverse[k], "x")
            bend = f" - {_n(x.square[k])}*v{k + 1}^2 - {_n(x.cube[k])}*v{k + 1}^3"
            definitions[f"v{k}"] = y if k == n - 1 else y + bend
        for k, place in enumerate(x.order):
            definitions[f"w{k}"] = f"v{place}"
        fields = [*core.equations, *(f"{_n(r)}*w{k}" for k, r in enumerate(x.rates, len(core.equations)))]
        rate = "" if core.kind == "map" else f"{_n(x.rate)}*"
        for k, place in enumerate(x.order):
            definitions[f"f{place}"] = f"{rate}({fields[k]})"
        for k in range(n):
            if k == n - 1:
                image = f"f{k}"
            elif core.kind == "map":
                image = f"f{k} + {_n(x.square[k])}*f{k + 1}^2 + {_n(x.cube[k])}*f{k + 1}^3"
            else:
                slope = f"(2*{_n(x.square[k])}*v{k + 1} + 3*{_n(x.cube[k])}*v{k + 1}^2)"
                image = f"f{k} + {slope}*f{k + 1}"
            definitions[f"g{k}"] = image
        equations = {f"x{k}": _sum(x.matrix[k], "g") for k in range(n)}
        start = {f"x{k}": 0.0 for k in range(n)}
        return Model(
            "planted", kind=core.kind, states=start, parameters={"p": 0.0, "q": 0.0}, definitions=definitions,
            equations=equations,
        )  # fmt: skip

    def states(self, w: Array) -> Array:
        """x at core states w (the other states are 0)."""
        x = self.numbers
        v = np.zeros(self.n)
        v[x.order[: len(w)]] = w
        y = v.copy()
        y[:-1] += x.square[:-1] * v[1:] ** 2 + x.cube[:-1] * v[1:] ** 3
        return np.asarray(x.matrix @ y)

    def image(self, *weights: complex, at: float = 0.0) -> Array:
        """The vector of x that belongs to a small change of w by the weights, from w0 = at and others 0."""
        x = self.numbers
        v, dv = np.zeros(self.n), np.zeros(self.n, complex)
        v[x.order[0]] = at
        dv[x.order[: len(weights)]] = weights
        dy = dv.copy()
        dy[:-1] += (2.0 * x.square[:-1] * v[1:] + 3.0 * x.cube[:-1] * v[1:] ** 2) * dv[1:]
        return np.asarray(x.matrix @ dy)

    def place(self, s: float) -> Array:
        """(p, q) on the curve."""
        x = self.numbers
        return np.asarray(x.at + np.linalg.solve(x.slopes, np.array(self.core.curve(s))))

    def exact_place(self, s: float) -> Array:
        """(p, q) at which A and B are as planted, by 40 digits from the numbers that the model was written with."""
        x = self.numbers
        with mp.workdps(40):
            away = mp.lu_solve(mp.matrix(x.slopes.tolist()), mp.matrix([mp.mpf(v) for v in self.core.curve(s)]))
            return np.array([float(mp.mpf(a) + d) for a, d in zip(x.at.tolist(), away, strict=True)])

    def expected(self) -> list[Event]:
        """The events between the ends of the curve's part in the box on which `begin` lies."""
        core = self.core
        low, high = core.begin, core.begin
        for s in np.linspace(core.begin, core.span[0], 4000):
            if np.abs(self.place(float(s))).max() > 1.0:
                break
            low = float(s)
        for s in np.linspace(core.begin, core.span[1], 4000):
            if np.abs(self.place(float(s))).max() > 1.0:
                break
            high = float(s)
        return [e for e in core.events if low < e.at < high]

    @property
    def is_clear(self) -> bool:
        """True where no event is close to the edge of the box, where it may or may not be found."""
        places = [np.abs(self.place(e.at)).max() for e in self.core.events]
        if min(np.abs(self.place(end)).max() for end in self.core.span) < 1.0:  # the curve is not known to its end
            return False
        return bool(np.abs(self.place(self.core.begin)).max() < 0.9) and all(abs(r - 1.0) > EDGE for r in places)

    def curve(self) -> Any:
        """The curve in (p, q), from a point of its type on a branch in p."""
        core, (at, q) = self.core, self.place(self.core.begin)
        for shift in (0.05, -0.05, 0.02, -0.02):
            start = self._equilibrium(at + shift, q)
            if start is None:
                continue
            line = contin.continuation(start, "p", (at - 0.1, at + 0.1))
            points = [p for p in line.points if p.type == core.type and abs(p.values["p"] - at) < 1e-5]
            if points:
                return contin.continuation(points[0].locus(("p", "q")), ("p", "q"), BOX)
        raise LookupError(f"no {core.type} at p = {at!r}, q = {q!r}")

    def _equilibrium(self, p: float, q: float) -> Any:
        core, x = self.core, self.numbers
        w0 = 0.0
        if core.rest is not None:
            roots = np.roots(core.rest(*(x.slopes @ (np.array([p, q]) - x.at))))
            real = [float(r.real) for r in roots if abs(r.imag) < 1e-12]
            if not real:
                return None
            w0 = min(real, key=lambda r: abs(r - core.state(core.begin)))
        w = np.zeros(len(core.equations))
        w[0] = w0
        names = self.model.state_names
        guess = dict(zip(names, map(float, self.states(w)), strict=True))
        return contin.equilibrium(self.model, guess, {"p": float(p), "q": float(q)})


@dataclass(frozen=True)
class Numbers:
    """The random numbers of a hidden system: x = M T(w), (A, B) = slopes ((p, q) - at)."""

    matrix: Array
    square: Array
    cube: Array
    order: Array  # place among the y of each w
    rates: Array
    rate: float
    slopes: Array
    at: Array

    @classmethod
    def drawn(cls, hidden: Hidden) -> Numbers:
        random, n = np.random.default_rng(hidden.seed), hidden.n
        few = len(hidden.core.equations)
        left, right = (np.linalg.qr(random.normal(size=(n, n)))[0] for _ in range(2))
        matrix = left @ np.diag(np.geomspace(1.0, 1.0 / hidden.condition, n)) @ right
        square, cube = random.uniform(-BEND, BEND, (2, n))
        signs = random.choice([-1.0, -1.0, 1.0], n - few)
        rates = signs * random.uniform(0.5, 2.0, n - few)
        if hidden.core.kind == "map":
            rates = signs * np.where(random.uniform(size=n - few) < 0.5, 0.5, 1.6) * random.uniform(0.8, 1.2, n - few)
        turn, stretch = random.uniform(0.0, 2.0 * np.pi), random.uniform(0.7, 1.4)
        c, s = np.cos(turn), np.sin(turn)
        slopes = np.array([[c, -s], [s, c]]) @ np.array([[1.0, random.uniform(-0.5, 0.5)], [0.0, stretch]])
        rate = 1.0 if hidden.core.kind == "map" else float(10.0 ** random.uniform(-1.0, 1.0))
        return cls(matrix, square, cube, random.permutation(n), rates, rate, slopes, random.uniform(-0.2, 0.2, 2))


def _n(value: float) -> str:
    return f"({float(value)!r})"


def _sum(weights: Array, prefix: str) -> str:
    return " + ".join(f"{_n(w)}*{prefix}{k}" for k, w in enumerate(weights))
