"""Connecting orbits to and from periodic orbits, as a boundary-value problem of known form (a model of kind: bvp).

On s in [0, 1], for each end of the orbit u that is a cycle y of period P, with adjoint modes w of it:

    u' = T f(u)            y' = P f(y), y(0) = y(1)            w' = -P f_u(y)^T w + sigma w,  w(1) = +-w(0),  |w(0)| = 1
    <w(0), u(e) - y(0)> = miss,      <f(y(0)), u(e) - y(0)> = 0

(the last product and the length of w(0) in the natural units of the states, which are given: these may differ)
where exp(sigma) is the size of a multiplier and +- its sign: of the unstable ones where the orbit arrives, of the
stable ones where it leaves; the last equation chooses the phase. An end that is an equilibrium x0 has

    f(x0) = 0,   f_u(x0) V = V L,   R^T V = 1,   u(e) = x0 + V c (+ miss),   |c| = distance

with V (n, k) a basis of its unstable (at the end: stable) eigenspace and R a fixed one of its dual. (Doedel, Kooi,
van Voorn and Kuznetsov, Int. J. Bifurcation and Chaos 18 (2008) 1889 and 19 (2009) 159.) The distances are parameters,
and so is T, in periods of the (first) cycle, so that phases stay where they are when the period changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from contin.model.expression import ONE, ZERO, Expression, add, div, mul, number, substitute, symbol
from contin.model.model import Model
from contin.model.parts import Condition, Functional, Interval, Parameter, State
from contin.model.printing import to_text
from contin.symbolic.calculus.derivatives import derivative

TIME = "T:"  # names with a colon are no user's
MISS = "miss:"
DISTANCE = "distance:"


@dataclass(frozen=True)
class CycleEnd:
    """Signs of the multipliers whose adjoint modes are projected out."""

    signs: tuple[int, ...]


@dataclass(frozen=True)
class SaddleEnd:
    """Dimension of the eigenspace that the orbit leaves or arrives in."""

    dimension: int


End = CycleEnd | SaddleEnd
AT = {"start": "1", "end": "2"}  # which end a name belongs to


@dataclass(frozen=True)
class Connecting:
    """The model of kind bvp; `free` are its own unknown constants: x0, V, L, c, P, sigma of both ends."""

    model: Model
    free: tuple[str, ...]

    @property
    def further(self) -> int:
        """How many parameters of the user's are solved for beside one that varies (or T, a miss, a distance)."""
        return len(self.model.conditions) - len(self.model.states) - len(self.free)


def connecting(model: Model, first: End, last: End, units: Sequence[float]) -> Connecting:
    """The boundary-value problem of orbits of a flow that lead from `first` to `last`; distances are in `units`."""
    writer = _Writer(model, units)
    time = symbol(TIME)
    for place, end in (("end", last), ("start", first)):
        if isinstance(end, CycleEnd):
            time = mul(symbol(TIME), symbol(f"period:{AT[place]}"))
    states = [State(name, ZERO) for name in model.state_names]
    equations = [mul(time, f) for f in model.equations]
    for place, end in (("start", first), ("end", last)):
        parts = writer.cycle(place, end) if isinstance(end, CycleEnd) else writer.saddle(place, end)
        states += [State(name, ZERO) for name in parts[0]]
        equations += parts[1]
    if isinstance(first, CycleEnd) and isinstance(last, CycleEnd):  # time may shift: the distance says where it begins
        gaps = writer.offsets("start", [writer.at(cycle_name(name, "start"), "start") for name in model.state_names])
        writer.conditions.append(_squares(writer.in_units(gaps)) - mul(symbol(f"{DISTANCE}1"), symbol(f"{DISTANCE}1")))
    known = [*dict.fromkeys([*writer.constants, MISS, TIME])]
    parameters = [*model.parameters, *(Parameter(name, ONE) for name in (*known, *writer.free))]
    built = Model.from_parts(
        name=model.name, kind="bvp", states=tuple(states), equations=tuple(equations), parameters=tuple(parameters),
        interval=Interval("s:", ZERO, ONE), functionals=dict(writer.functionals),
        conditions=tuple(Condition(f"{to_text(c)} = 0", c) for c in writer.conditions),
    )  # fmt: skip
    return Connecting(built, tuple(writer.free))


def cycle_name(state: str, place: str) -> str:
    """A state on the cycle at an end: with a word after the colon, as no constant has (a state may be named `c0`)."""
    return f"{state}:cycle{AT[place]}"


def adjoint_name(state: str, place: str, mode: int) -> str:
    """A component of an adjoint mode of the cycle at an end."""
    return f"{state}:w{mode}:{AT[place]}"


def _product(a: list[Expression], b: list[Expression]) -> Expression:
    return add(*(mul(x, y) for x, y in zip(a, b, strict=True)))


def _squares(terms: list[Expression]) -> Expression:
    return _product(terms, terms)


class _Writer:
    """Equations and conditions of the ends of an orbit."""

    def __init__(self, model: Model, units: Sequence[float]) -> None:
        self.units = [number(unit) for unit in units]
        self.names = list(model.state_names)
        self.f = list(model.equations)
        self.jacobian = [[derivative(f, name) for name in self.names] for f in self.f]
        self.free: list[str] = []
        self.constants: list[str] = []
        self.conditions: list[Expression] = []
        self.functionals: dict[str, Functional] = {}

    def at(self, state: str, place: str) -> Expression:
        """The value of a function at an end of the interval."""
        name = f"{state}({place})"
        self.functionals[name] = Functional(place, symbol(state))
        return symbol(name)

    def new(self, name: str) -> Expression:
        self.free.append(name)
        return symbol(name)

    def constant(self, name: str) -> Expression:
        self.constants.append(name)
        return symbol(name)

    def moved(self, what: list[Expression], images: list[Expression]) -> list[Expression]:
        """Formulas with the states replaced."""
        return substitute(what, dict(zip(map(symbol, self.names), images, strict=True)))

    def in_units(self, vector: list[Expression]) -> list[Expression]:
        return [div(part, unit) for part, unit in zip(vector, self.units, strict=True)]

    def offsets(self, place: str, base: list[Expression]) -> list[Expression]:
        return [self.at(name, place) - b for name, b in zip(self.names, base, strict=True)]

    def cycle(self, place: str, end: CycleEnd) -> tuple[list[str], list[Expression]]:
        """Names and equations of the cycle and its adjoint modes."""
        own = [cycle_name(name, place) for name in self.names]
        y = [symbol(name) for name in own]
        period = self.new(f"period:{AT[place]}")
        names, equations = list(own), [mul(period, f) for f in self.moved(self.f, y)]
        base = [self.at(name, "start") for name in own]
        self.conditions += [a - self.at(name, "end") for name, a in zip(own, base, strict=True)]
        gap = self.offsets(place, base)
        speed = self.moved(self.f, base)
        self.conditions.append(_product(self.in_units(speed), self.in_units(gap)))
        rows = [self.moved(row, y) for row in self.jacobian]
        for k, sign in enumerate(end.signs):
            modes = [adjoint_name(name, place, k) for name in self.names]
            w, sigma = [symbol(name) for name in modes], self.new(f"sigma{k}:{AT[place]}")
            for j in range(len(modes)):
                along = add(*(mul(rows[i][j], w[i]) for i in range(len(modes))))
                equations.append(mul(sigma, w[j]) - mul(period, along))
            names += modes
            first = [self.at(name, "start") for name in modes]
            self.conditions += [self.at(n, "end") - mul(number(sign), a) for n, a in zip(modes, first, strict=True)]
            self.conditions.append(_squares([mul(a, unit) for a, unit in zip(first, self.units, strict=True)]) - ONE)
            part = _product(first, gap)
            self.conditions.append(part - mul(symbol(MISS), self.constant(f"part{k}:{AT[place]}")))
        if place == "start":
            self.constants.append(f"{DISTANCE}1")
        return names, equations

    def saddle(self, place: str, end: SaddleEnd) -> tuple[list[str], list[Expression]]:
        """An equilibrium and a basis of its eigenspace are constants: no functions."""
        mark, n, k = AT[place], len(self.names), end.dimension
        x = [self.new(f"{name}:saddle{mark}") for name in self.names]
        v = [[self.new(f"v{i}{j}:{mark}") for j in range(k)] for i in range(n)]
        small = [[self.new(f"l{i}{j}:{mark}") for j in range(k)] for i in range(k)]
        c = [self.new(f"c{j}:{mark}") for j in range(k)]
        r = [[self.constant(f"r{i}{j}:{mark}") for j in range(k)] for i in range(n)]
        self.conditions += self.moved(self.f, x)
        matrix = [self.moved(row, x) for row in self.jacobian]
        for i in range(n):
            for j in range(k):
                left = add(*(mul(matrix[i][m], v[m][j]) for m in range(n)))
                self.conditions.append(left - add(*(mul(v[i][m], small[m][j]) for m in range(k))))
        for i in range(k):
            for j in range(k):
                product = add(*(mul(r[m][i], v[m][j]) for m in range(n)))
                self.conditions.append(product - number(int(i == j)))
        parts = [self.constant(f"part{i}:{mark}") for i in range(n)]
        missed = [mul(symbol(MISS), part) for part in parts]
        for name, a, row, off in zip(self.names, x, v, missed, strict=True):
            self.conditions.append(self.at(name, place) - add(a, off, *(mul(row[j], c[j]) for j in range(k))))
        self.conditions.append(_squares(c) - mul(*[self.constant(f"{DISTANCE}{mark}")] * 2))
        return [], []
