"""One turn of an oscillation cut where a piecewise function changes formula.

Along x = r cos(phi), y = -omega r sin(phi) the cuts and their order depend on the amplitude r: `regions` lists the
intervals of r in which they do not, and for each of them the arcs of the turn with the formula that holds on each.
The order is decided with the default parameters; `Region.assumptions` of the whole says what that presumes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

from contin.machine import elementary
from contin.model.evaluate import evaluate_all
from contin.model.expression import ONE, ZERO, Expression, add, call, mul, number, substitute
from contin.model.printing import to_text
from contin.records import Sympy
from contin.symbolic.averaging.switching_lines import (
    Circle,
    Line,
    X,
    Y,
    number_of,
    state_comparisons,
    switching_sets,
)
from contin.symbolic.calculus.sympy_bridge import from_sympy, sympy_symbol, to_sympy

if TYPE_CHECKING:
    from types import ModuleType

Presumption = tuple[Expression, str]  # a margin that is negative where it does not hold, and in words
SAME = 1e-9  # radii and angles closer than this are one
RADIUS = "@r"
"""The amplitude in averages, before it gets the name of a state."""


@dataclass(frozen=True)
class Cut:
    """A point of the turn: cos(phi), sin(phi), phi as sympy formulas in r and the parameters, and phi as a number."""

    cos: Sympy
    sin: Sympy
    phi: Sympy
    number: float
    exact: bool  # a multiple of a quarter turn


@dataclass(frozen=True)
class Arc:
    """The piece of the turn from `start` to `stop` (counterclockwise), on which the function is `formula`."""

    start: Cut
    stop: Cut
    formula: Expression


@dataclass(frozen=True)
class Region:
    """Amplitudes between `low` and `high` (None: no bound), as sympy formulas and as numbers."""

    low: Sympy | None
    high: Sympy | None
    numbers: tuple[float, float]
    arcs: tuple[Arc, ...]

    def numbers_at(self, values: Mapping[str, float]) -> tuple[float, float]:
        """The bounds at other values of the parameters."""
        low = 0.0 if self.low is None else number_of(self.low, values)
        return low, math.inf if self.high is None else number_of(self.high, values)

    @property
    def sample(self) -> float:
        """An amplitude inside."""
        low, high = self.numbers
        return 0.5 * (low + high) if math.isfinite(high) else 1.7 * low + (1.0 if low == 0 else 0.0)


def regions(
    function: Expression, omega: Expression, values: Mapping[str, float], positive: tuple[str, ...]
) -> tuple[list[Region], list[Presumption]]:
    """The regions of amplitude of a one-oscillator function, from r = 0 outwards, and what their order presumes.

    Arcs with formula 0 are left out.
    """
    lines, circles = switching_sets(function, omega, values, positive)
    radii, order = _critical_radii(lines, circles, omega, values, positive)
    bounds: list[tuple[Sympy | None, float]] = [(None, 0.0), *radii, (None, math.inf)]
    found: list[Region] = []
    for (low, a), (high, b) in pairwise(bounds):
        region = Region(low, high, (a, b), ())
        arcs = _arcs(function, lines, omega, region.sample, values, positive)
        if found and _alike(found[-1].arcs, arcs):  # nothing changes at this radius
            found[-1] = Region(found[-1].low, high, (found[-1].numbers[0], b), found[-1].arcs)
        else:
            found.append(Region(low, high, (a, b), arcs))
    return found, [*order, *_signs(lines)]


def _alike(one: Sequence[Arc], other: Sequence[Arc]) -> bool:
    return len(one) == len(other) and all(
        a.formula is b.formula and (a.start.phi, a.stop.phi) == (b.start.phi, b.stop.phi)
        for a, b in zip(one, other, strict=True)
    )


def _critical_radii(
    lines: Sequence[Line],
    circles: Sequence[Circle],
    omega: Expression,
    values: Mapping[str, float],
    positive: tuple[str, ...],
) -> tuple[list[tuple[Sympy, float]], list[Presumption]]:
    """Amplitudes at which an oscillation touches a line, passes an intersection of two, or is a circle; ascending.

    And what is presumed of those that are formulas in parameters: their order, and that those which are equal (or 0)
    for the default parameters stay so.
    """
    import sympy

    w = to_sympy(omega, positive)
    candidates = [c.radius for c in circles]
    candidates += [sympy.Abs(e.c) / sympy.sqrt(e.a**2 + e.b**2 * w**2) for e in lines]
    for one, two in combinations(lines, 2):
        determinant = sympy.simplify(one.a * two.b - two.a * one.b)
        if determinant != 0 and not (one.c == 0 and two.c == 0):
            x = (one.b * two.c - two.b * one.c) / determinant
            y = (two.a * one.c - one.a * two.c) / determinant
            candidates.append(sympy.sqrt(x**2 + y**2 / w**2))
    found: list[tuple[Sympy, float]] = []
    presumed: list[Presumption] = []
    for candidate in candidates:
        radius = _positive(sympy.simplify(candidate), values)
        value = number_of(radius, values)
        like = next((other for other, size in found if abs(value - size) <= SAME * value), None)
        if value <= SAME:
            if radius.free_symbols:
                presumed.append((_equality(radius, sympy.Integer(0)), f"{_text(radius)} = 0"))
        elif like is None:
            found.append((radius, value))
        elif sympy.simplify(radius - like) != 0:
            presumed.append((_equality(radius, like), f"{_text(radius)} = {_text(like)}"))
    found.sort(key=lambda pair: pair[1])
    for (low, _), (high, _) in pairwise([(sympy.Integer(0), 0.0), *found]):
        if low.free_symbols or high.free_symbols:
            presumed.append((from_sympy(high - low), f"{_text(low)} < {_text(high)}"))
    return found, presumed


def _equality(one: Sympy, two: Sympy) -> Expression:
    """Not negative where two amplitudes are equal to the accuracy of a comparison."""
    slack = add(number(SAME), mul(number(SAME), call("abs", from_sympy(two))))
    return add(slack, mul(number(-1), call("abs", from_sympy(one - two))))


def _signs(lines: Sequence[Line]) -> list[Presumption]:
    """Signs of coefficients that decide on which side of a line through one coordinate alone an angle lies."""
    found = []
    for line in lines:
        for k, other in ((0, line.b), (1, line.a)):
            coefficient = (line.a, line.b)[k]
            if other == 0 and coefficient.free_symbols:
                sign = 1 if line.numbers[k] > 0 else -1
                found.append((from_sympy(sign * coefficient), f"{_text(coefficient)} {'>' if sign > 0 else '<'} 0"))
    return found


def _text(formula: Sympy) -> str:
    return to_text(from_sympy(formula))


def _positive(radius: Sympy, values: Mapping[str, float]) -> Sympy:
    """|c| without its bars, for the sign that c has with the default parameters."""
    import sympy

    return radius.replace(sympy.Abs, lambda inner: inner if number_of(inner, values) >= 0 else -inner)


def _arcs(
    function: Expression,
    lines: Sequence[Line],
    omega: Expression,
    radius: float,
    values: Mapping[str, float],
    positive: tuple[str, ...],
) -> tuple[Arc, ...]:
    cuts = _cuts(lines, omega, radius, values, positive)
    w = number_of(to_sympy(omega, positive), values)
    pieces: list[list[Sympy]] = []
    for start, stop in zip(cuts, [*cuts[1:], _shifted(cuts[0])], strict=True):
        middle = 0.5 * (start.number + stop.number)
        point = {**values, X: radius * elementary.cos(middle), Y: -w * radius * elementary.sin(middle)}
        formula = resolved(function, point)
        if pieces and pieces[-1][2] is formula:
            pieces[-1][1] = stop
        else:
            pieces.append([start, stop, formula])
    if len(pieces) > 1 and pieces[-1][2] is pieces[0][2]:  # one arc over the end of the list
        pieces[0][0] = _shifted(pieces.pop()[0], -1)
    return tuple(Arc(*piece) for piece in pieces if piece[2] is not ZERO)


def resolved(function: Expression, point: Mapping[str, float]) -> Expression:
    """The formula that holds at a point: conditions in x and y decided, those in parameters alone left."""
    comparisons = state_comparisons(function)
    truth = evaluate_all(comparisons, point)
    return substitute([function], {c: ONE if t else ZERO for c, t in zip(comparisons, truth, strict=True)})[0]


def _cuts(
    lines: Sequence[Line], omega: Expression, radius: float, values: Mapping[str, float], positive: tuple[str, ...]
) -> list[Cut]:
    """All points where the oscillation of this amplitude crosses a line, in order; at least one."""
    found: list[Cut] = []
    for line in lines:
        for cut in _crossings(line, omega, radius, values, positive):
            if not any(abs(math.remainder(cut.number - other.number, 2 * math.pi)) <= SAME for other in found):
                found.append(cut)
    return sorted(found, key=lambda cut: cut.number) or [quarter(0)]


def quarter(k: int) -> Cut:
    """phi = k pi/2"""
    import sympy

    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[k % 4]
    return Cut(sympy.Integer(cos), sympy.Integer(sin), k * sympy.pi / 2, k * math.pi / 2, True)


def _shifted(cut: Cut, turns: int = 1) -> Cut:
    import sympy

    return Cut(cut.cos, cut.sin, cut.phi + 2 * turns * sympy.pi, cut.number + 2 * turns * math.pi, cut.exact)


def _crossings(
    line: Line, omega: Expression, radius: float, values: Mapping[str, float], positive: tuple[str, ...]
) -> list[Cut]:
    """a x + b y + c = D r cos(phi + delta) + c with D cos(delta) = a, D sin(delta) = b omega."""
    import sympy

    w = to_sympy(omega, positive)
    a, b, c = line.numbers
    w_number = number_of(w, values)
    size = elementary.hypot(a, b * w_number)
    if size == 0 or abs(c) >= size * radius:
        return []
    if line.c == 0 and (line.a == 0 or line.b == 0):
        return [quarter(0), quarter(2)] if line.a == 0 else [quarter(1), quarter(3)]
    r = sympy_symbol(RADIUS, positive=True)
    length = sympy.sqrt(line.a**2 + line.b**2 * w**2)
    level = sympy.simplify(-line.c / (length * r))
    other = sympy.sqrt(1 - level**2)
    cos_delta, sin_delta = sympy.simplify(line.a / length), sympy.simplify(line.b * w / length)
    delta, delta_number = _angle(sympy, line, cos_delta, sin_delta), elementary.atan2(b * w_number, a)
    cuts = []
    for sign in (1, -1):
        beta = sign * elementary.acos(-c / (size * radius))
        phi = sign * sympy.acos(level) - delta
        number = beta - delta_number
        turns = -math.floor(number / (2 * math.pi) + SAME)
        cuts.append(
            Cut(
                level * cos_delta + sign * other * sin_delta,
                sign * other * cos_delta - level * sin_delta,
                phi + 2 * turns * sympy.pi,
                number + 2 * math.pi * turns,
                False,
            )
        )
    return cuts


def _angle(sympy: ModuleType, line: Line, cos_delta: Sympy, sin_delta: Sympy) -> Sympy:
    if line.b == 0:
        return sympy.Integer(0) if line.numbers[0] > 0 else sympy.pi
    if line.a == 0:
        return sympy.pi / 2 if line.numbers[1] > 0 else -sympy.pi / 2
    return sympy.atan2(sin_delta, cos_delta)


def assumptions(found: Sequence[Region]) -> list[str]:
    """What the order of the critical radii presumes about parameters: '0 < x1 < x2'; nothing where they are numbers."""
    radii = [region.high for region in found if region.high is not None]
    if not any(radius.free_symbols for radius in radii):
        return []
    return [" < ".join(["0", *(to_text(from_sympy(radius)) for radius in radii)])]
