"""Where a denominator vanishes: points w = 0 of a local variable w about which quotients are expanded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from contin.model.expression import ONE, ZERO, Expression, add, depends_on, mul, postorder, sub, substitute, symbol
from contin.model.vocabulary import UNARY_FUNCTIONS
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.series_arithmetic import reciprocal

LOCAL: Final = "@w"  # name of the local variable; it cannot occur in a model
LARGEST: Final = 400  # nodes of a denominator or quotient that is looked into


@dataclass(frozen=True)
class Centre:
    """The zero set of `w`, a formula in the model's symbols; `replaced` expressed by the local variable is `by`.

    Either a symbol is replaced by its solution of w = w(symbol), affine in it, or the formula w itself by the variable.
    """

    w: Expression
    replaced: Expression
    by: Expression

    def local(self, expressions: Sequence[Expression]) -> list[Expression]:
        """The expressions as functions of the local variable."""
        return substitute(expressions, {self.replaced: self.by})


def centres(denominator: Expression, partners: Sequence[Expression], shared: int = 0) -> Iterator[Centre]:
    """Candidates for zeros of `denominator` that could be zeros of `partners` (factors beside it) too.

    shared : mask of symbols of which one must occur, beside those of the partners.

    Arguments of functions come first: they have no units, so "small" means something. Nothing is verified here.
    """
    for partner in partners:
        shared |= partner.mask
    seen: set[Expression] = set()
    for w in _vanishing_formulas(denominator, partners):
        if not w.mask & shared or w in seen:
            continue
        seen.add(w)
        solved = False
        for centre in _solutions(w, shared):
            solved = True
            yield centre
        if not solved and w.op != "symbol":
            yield Centre(w, w, symbol(LOCAL))


def _vanishing_formulas(denominator: Expression, partners: Sequence[Expression]) -> Iterator[Expression]:
    nodes = postorder([denominator])
    if len(nodes) > LARGEST:
        return
    calls = [node for node in nodes if node.op in UNARY_FUNCTIONS and node.mask]
    yield from (node.args[0] for node in calls)
    if denominator.op == "log":
        yield sub(denominator.args[0], ONE)
    yield from (node.args[1] for node in nodes if node.op == "pow" and node.args[1].mask)
    for i, first in enumerate(calls):
        yield from (sub(first.args[0], other.args[0]) for other in calls[i + 1 :] if other.op == first.op)
    yield from (factor for factor in denominator.args if denominator.op == "mul" and factor.mask)
    yield denominator
    yield from (node for node in nodes if node.op == "symbol")
    yield from (node.args[0] for node in nodes if node.op == "pow" and node.args[0].mask)
    for partner in partners:
        factors = partner.args if partner.op == "mul" else (partner,)
        yield from (f.args[0] if f.op == "pow" else f for f in factors if f.op in ("add", "pow"))


def _solutions(w: Expression, shared: int) -> list[Centre]:
    """w = a s + b solved for each symbol s that it is affine in; numeric a first."""
    found: list[tuple[bool, Centre]] = []
    for node in postorder([w]):
        if node.op != "symbol" or not node.mask & shared:
            continue
        name = str(node.value)
        slope = derivative(w, name)
        if slope is ZERO or depends_on(slope, [name]):
            continue
        (offset,) = substitute([w], {node: ZERO})
        inverse = reciprocal(slope)
        solution = add(mul(-1, offset, inverse), mul(symbol(LOCAL), inverse))
        found.append((slope.mask != 0, Centre(w, node, solution)))
    found.sort(key=lambda item: item[0])
    return [centre for _, centre in found]
