"""Averages of a function of one oscillator over a turn, as formulas in its amplitude r.

    S(r) = <f(r cos phi, -omega r sin phi) sin phi>,    C(r) = <f(r cos phi, -omega r sin phi) cos phi>

Closed where `trig_integrals` has a rule, otherwise a Gauss rule; piece by piece in r where conditions make it so. Each
closed form is compared with a Gauss rule before it is used.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Vector
from contin.errors import InputError
from contin.model.expression import (
    ONE,
    ZERO,
    Expression,
    add,
    call,
    compare,
    if_,
    mul,
    number,
    postorder,
    sub,
    substitute,
    symbol,
)
from contin.model.parts import Limit
from contin.model.printing import to_text
from contin.records import Sympy
from contin.symbolic.averaging.cells import RADIUS, SAME, Arc, Region, assumptions, quarter, regions
from contin.symbolic.averaging.gauss_rule import (
    ACCURACY,
    Array,
    agreement,
    angle_of,
    arc_rule,
    at_state,
    beyond_quadrature,
    next_size,
    rule_size,
    sampled_averages,
    turn_rule,
)
from contin.symbolic.averaging.parity import arcs_parity
from contin.symbolic.averaging.rule_values import COS, SIN, Segment, arc_values, turn_values
from contin.symbolic.averaging.switching_lines import PLANE, X, Y
from contin.symbolic.averaging.terms import additive_terms, without_kinks
from contin.symbolic.averaging.tidy import tidy
from contin.symbolic.averaging.trig_integrals import trig_integral
from contin.symbolic.calculus.sympy_bridge import BridgeError, all_to_sympy, from_sympy, sympy_symbol, to_sympy

if TYPE_CHECKING:
    from types import ModuleType

SHARES: Final = (1.0, 0.5, 0.25)  # of the way to the ends of the parameters' ranges
INWARDS: Final = (1.0, 0.5, 0.25)  # parts of the amplitudes up to `reach`, of which the last are those of the starts
AGREES: Final = 1e-9  # closed form and Gauss rule, relative to the largest value
SHORT: Final = 60  # nodes of a formula that is worth simplifying
R: Final = symbol(RADIUS)


@dataclass(frozen=True)
class Setting:
    """What an average is taken with: the frequency, the parameters' default values, and the largest amplitude and the
    parameters' values for which quadratures are checked."""

    omega: Expression
    values: Mapping[str, float]
    reach: float = 4.0
    corners: tuple[Mapping[str, float], ...] = ()
    signless: frozenset[str] = frozenset()  # slow states: nothing is presumed of their signs

    def towards_corners(self) -> Iterator[list[Mapping[str, float]]]:
        """Sets of parameter values to check a rule at: out to the corners, half of the way, a quarter, the defaults.

        The first for which there is a rule serves: at a far corner a function may change too fast for any.
        """
        for share in SHARES if self.corners else ():
            yield [
                self.values,
                *({n: v + share * (c[n] - v) for n, v in self.values.items()} for c in self.corners),
            ]
        yield [self.values]

    @property
    def positive(self) -> tuple[str, ...]:
        """Parameters that closed forms may take as positive."""
        return tuple(name for name, value in self.values.items() if value > 0 and name not in self.signless)


def presumed(margin: Expression, words: str) -> Limit:
    """A limit of closed forms: what they presume about the parameters."""
    return Limit(
        margin,
        f"the closed forms of the average presume {words}: average with default values of the parameters (in a run "
        "file: `parameters:`) for which the order is the other one",
    )


@dataclass(frozen=True)
class Piece:
    """S and C for amplitudes below `high` (None: for all larger ones) and above the piece before."""

    high: Expression | None
    bound: float
    sin: Expression
    cos: Expression
    arcs: tuple[Arc, ...] = ()
    nodes: int = 0  # of the Gauss rule on an arc; 0: closed form
    agreement: Expression | None = None  # of a rule with the next one, in R: negative where it is not accurate


@dataclass(frozen=True)
class RadialAverage:
    """S(r) and C(r), from r = 0 outwards.

    `presumes` are the conditions on parameters under which the forms hold, in words; `limits` all that they presume,
    quadratures also of the amplitude, the symbol R.
    """

    pieces: tuple[Piece, ...]
    presumes: tuple[str, ...] = ()
    limits: tuple[Limit, ...] = ()

    def sin(self, radius: Expression = R) -> Expression:
        """S(r)"""
        return self.chain(lambda piece: piece.sin, radius)

    def cos(self, radius: Expression = R) -> Expression:
        """C(r)"""
        return self.chain(lambda piece: piece.cos, radius)

    def chain(self, part: Callable[[Piece], Expression], radius: Expression = R) -> Expression:
        """`part` of the pieces as one conditional formula in r."""
        value = part(self.pieces[-1])
        for piece in reversed(self.pieces[:-1]):
            assert piece.high is not None
            value = if_(compare("<", R, piece.high), part(piece), value)
        return substitute([value], {R: radius})[0]

    def with_agreement(self) -> RadialAverage:
        """The same with the agreement of its quadratures among its limits."""
        if not any(piece.agreement for piece in self.pieces):
            return self
        nodes = max(piece.nodes for piece in self.pieces)
        margin = self.chain(lambda piece: piece.agreement or ZERO)
        return replace(self, limits=(*self.limits, Limit(margin, beyond_quadrature(nodes), ACCURACY)))

    @property
    def is_zero(self) -> bool:
        """True where both averages vanish at all amplitudes."""
        return all(p.sin is ZERO and p.cos is ZERO for p in self.pieces)


def average_over_turn(function: Expression, setting: Setting) -> RadialAverage:
    """S and C of one function of `switching_lines.X` and `.Y`.

    Raises
    ------
    InputError
        A condition's sign changes cannot be located, or no quadrature is accurate enough.
    """
    function = without_kinks(function, PLANE)
    found, order = regions(function, setting.omega, setting.values, setting.positive)
    pieces, presumes, signs = [], assumptions(found), []
    for region in found:
        piece, needs = _piece(region, setting)
        pieces.append(piece)
        signs += needs
        needs = [f"{name} > 0" for name in needs]
        presumes += [n for n in needs if n not in presumes and f" {n[:-4]} " not in " ".join([*presumes, ""])]
    limits = [presumed(margin, words) for margin, words in order]
    limits += [presumed(symbol(name), f"{name} > 0") for name in dict.fromkeys(signs)]
    return RadialAverage(tuple(pieces), tuple(presumes), tuple(limits)).with_agreement()


def _piece(region: Region, setting: Setting) -> tuple[Piece, list[str]]:
    high = None if region.high is None else from_sympy(region.high)
    bound = region.numbers[1]
    parity = arcs_parity(region.arcs, setting.values, setting.reach)
    if not region.arcs or parity > 0:
        return Piece(high, bound, ZERO, ZERO, region.arcs), []
    odd = parity < 0
    arcs, fold = (_first_half(region.arcs), 2) if odd else (region.arcs, 1)
    radii = _radii(region, setting.reach)
    closed = _closed(arcs, setting, fold)

    def rule(n: int) -> tuple[Expression, Expression, Expression]:
        if _is_whole(region.arcs):
            return turn_rule(region.arcs[0].formula, setting.omega, R, n, odd)
        return arc_rule(arcs, setting.omega, R, n, fold)

    segments = [_segment(arc, setting) for arc in arcs]

    def values(n: int, at: Mapping[str, float] = setting.values, radii: Vector = radii) -> Array:
        if _is_whole(region.arcs):
            return turn_values(segments[0].integrand, n, {**at, RADIUS: radii}, odd)
        return arc_values(segments, n, {**at, RADIUS: radii}, fold)

    def values_everywhere(n: int, corners: Sequence[Mapping[str, float]], part: float = 1.0) -> Array:
        within = radii[0] + part * (radii - radii[0])
        return np.hstack([values(n, corner, within) for corner in corners])

    if closed is not None:
        sin, cos, needs = closed
        own, coarse, fine = sampled_averages((sin, cos), radii, setting.values), values(48), values(64)
        scale = max(float(np.max(np.abs(fine))), 1e-300)
        # the rule checks the closed form as far as it is accurate itself
        allowed = AGREES * scale + 10 * float(np.max(np.abs(coarse - fine)))
        if np.all(np.isfinite(own)) and np.max(np.abs(own - fine)) <= allowed:
            return Piece(high, bound, sin, cos, region.arcs), needs
    corners = [[c for c in some if _lies_inside(region, radii, c)] for some in setting.towards_corners()]
    n = _size_within(values_everywhere, corners)
    sin, cos, square = rule(n)
    margin = agreement((sin, cos), rule(next_size(n))[:2], square)
    return Piece(high, bound, sin, cos, region.arcs, n, margin), []


def _size_within(values: Callable[..., Array], corners: Sequence[Sequence[Mapping[str, float]]]) -> int:
    """The size of a rule up to the largest amplitudes for which there is one: beyond them branches end, in words."""
    for part in INWARDS[:-1]:
        try:
            return first_size(partial(values, part=part), corners)
        except InputError:
            continue
    return first_size(partial(values, part=INWARDS[-1]), corners)


def _segment(arc: Arc, setting: Setting) -> Segment:
    start, stop = (cut.number if cut.exact else angle_of(cut, R) for cut in (arc.start, arc.stop))
    integrand = at_state(arc.formula, mul(R, COS), mul(number(-1), setting.omega, R, SIN))
    return Segment(start, stop, integrand)


def _lies_inside(region: Region, radii: Sympy, values: Mapping[str, float]) -> bool:
    """True where the radii lie inside the region at other values of the parameters too."""
    low, high = region.numbers_at(values)
    return bool(low < radii[0] and radii[-1] < high)


def first_size(
    integrands: Callable[[int, Sequence[Mapping[str, float]]], Array],
    sets: Iterable[Sequence[Mapping[str, float]]],
    size_of: float = 0.0,
) -> int:
    """The size of a rule that is accurate at the first of several sets of parameter values for which there is one."""
    tried = iter(sets)
    at = next(tried)
    while True:
        try:
            return rule_size(partial(_at, integrands, at), size_of)
        except InputError:
            following = next(tried, None)
            if following is None:
                raise
            at = following


def _at(
    integrands: Callable[[int, Sequence[Mapping[str, float]]], Array], corners: Sequence[Mapping[str, float]], n: int
) -> Array:
    return integrands(n, corners)


def _is_whole(arcs: Sequence[Arc]) -> bool:
    return len(arcs) == 1 and arcs[0].stop.number - arcs[0].start.number > 6.28


def _first_half(arcs: tuple[Arc, ...]) -> tuple[Arc, ...]:
    """One arc of each pair half a turn apart; of the whole turn, its first half."""
    if _is_whole(arcs):
        return (Arc(quarter(0), quarter(2), arcs[0].formula),)
    return tuple(a for a in arcs if (0.5 * (a.start.number + a.stop.number)) % (2 * math.pi) < math.pi - 1e-9)


def _radii(region: Region, reach: float) -> Vector:
    """Sample amplitudes inside a region; in the last one up to `reach`."""
    low, high = region.numbers
    if not math.isfinite(high):
        high = max(reach, 2.0 * low, 1.0)
    return low + (high - low) * np.array([0.037, 0.21, 0.43, 0.64, 0.83, 0.99])


def _closed(arcs: Sequence[Arc], setting: Setting, fold: int) -> tuple[Expression, Expression, list[str]] | None:
    """(S, C, the parameters that they presume to be positive) in closed form, or None."""
    import sympy

    omega = to_sympy(setting.omega, setting.positive)
    x, y, r = sympy_symbol(X), sympy_symbol(Y), sympy_symbol(RADIUS, positive=True)
    sums: list[list[tuple[Expression, object]]] = [[], []]
    needs: set[str] = set()
    for formula in dict.fromkeys(arc.formula for arc in arcs):
        own = [arc for arc in arcs if arc.formula is formula]
        for coefficient, term in additive_terms(formula, PLANE):
            try:
                both = trig_integral(to_sympy(term, setting.positive), x, y, r, omega, own)
            except (sympy.PolynomialError, NotImplementedError, ZeroDivisionError):
                return None
            if both is None:
                return None
            for total, value in zip(sums, both, strict=True):
                total.append((coefficient, fold * value / (2 * sympy.pi)))
    results = []
    for total in sums:
        collected: dict[Expression, object] = {}
        for coefficient, value in total:
            factor, rest = (coefficient, ONE) if not coefficient.is_number else (ONE, coefficient)
            collected[factor] = collected.get(factor, 0) + value * to_sympy(rest)
        terms = []
        for coefficient, value in collected.items():
            value = tidy(value, r)
            if value.has(sympy.I, sympy.zoo, sympy.nan, sympy.oo):
                return None
            needs |= _presumed(sympy, value, r)
            try:
                terms.append(mul(coefficient, from_sympy(value)))
            except BridgeError:
                return None
        results.append(add(*terms) if terms else ZERO)
    return results[0], results[1], sorted(needs)


def _presumed(sympy: ModuleType, value: object, r: object) -> set[str]:
    """Parameters under roots, logarithms and arc tangents: there their sign was used."""
    names: set[str] = set()
    for node in sympy.preorder_traversal(value):
        irrational = node.is_Pow and not node.exp.is_integer
        if irrational or isinstance(node, (sympy.log, sympy.atan, sympy.acos)):
            names |= {s.name for s in node.free_symbols if s.is_positive and s != r}
    return names


def combined(parts: Sequence[tuple[Expression, RadialAverage]], positive: Collection[str] = ()) -> RadialAverage:
    """sum of c * average, on the common refinement of their pieces."""
    if not parts:
        return RadialAverage((Piece(None, math.inf, ZERO, ZERO),))
    bounds: dict[float, Expression | None] = {}
    merged: list[tuple[Expression, Expression]] = []
    for _, average in parts:
        for piece in average.pieces:
            known = bounds.setdefault(piece.bound, piece.high)
            if known is not None and piece.high is not None and known is not piece.high:
                merged.append((known, piece.high))
    pieces: list[Piece] = []
    for bound in sorted(bounds):
        chosen = [(c, next(p for p in a.pieces if p.bound >= bound * (1 - 1e-12))) for c, a in parts]
        sin, cos = (_collected([(c, getattr(p, part)) for c, p in chosen], positive) for part in ("sin", "cos"))
        arcs = tuple(arc for _, p in chosen for arc in p.arcs)
        nodes = max(p.nodes for _, p in chosen)
        if pieces and pieces[-1].sin is sin and pieces[-1].cos is cos:
            pieces.pop()
        pieces.append(Piece(bounds[bound], bound, sin, cos, arcs, nodes))
    presumes = dict.fromkeys(p for _, average in parts for p in average.presumes)
    limits = [*(limit for _, average in parts for limit in average.limits), *_in_order(bounds, merged)]
    return RadialAverage(tuple(pieces), tuple(presumes), tuple(dict.fromkeys(limits)))


def _in_order(
    bounds: Mapping[float, Expression | None], merged: Sequence[tuple[Expression, Expression]]
) -> list[Limit]:
    """What the common refinement presumes: the order of the thresholds of all parts, and that equal ones stay equal."""
    ordered = [bounds[bound] for bound in sorted(bounds)]
    thresholds = [high for high in ordered if high is not None]
    limits = [
        presumed(sub(two, one), f"{to_text(one)} < {to_text(two)}")
        for one, two in pairwise(thresholds)
        if not (one.is_number and two.is_number)
    ]
    for one, two in merged:
        margin = sub(mul(number(SAME), call("abs", one)), call("abs", sub(one, two)))
        limits.append(presumed(margin, f"{to_text(one)} = {to_text(two)}"))
    return limits


def _collected(terms: Sequence[tuple[Expression, Expression]], positive: Collection[str]) -> Expression:
    """sum of c * f; closed forms with numeric factors are put together and simplified."""
    products = [(mul(c, f), c.is_number and len(postorder([f])) < SHORT) for c, f in terms if f is not ZERO]
    plain = [p for p, short in products if short]
    if len(plain) > 1:
        import sympy

        total = sympy.Add(*all_to_sympy(plain, (*positive, RADIUS)))
        plain = [from_sympy(tidy(total, sympy_symbol(RADIUS, positive=True)))]
    return add(*(p for p, short in products if not short), *plain)
