"""A formula rewritten by sympy where that makes it shorter; long formulas are left as they are."""

from __future__ import annotations

from typing import Final

from contin.model.expression import Expression, postorder
from contin.symbolic.calculus.sympy_bridge import BridgeError, from_sympy, to_sympy

LIMIT: Final = 120  # nodes; sympy's time grows fast beyond


def shorter(formula: Expression) -> Expression:
    """An equal formula, on the common domain, with at most as many nodes."""
    before = len(postorder([formula]))
    if before > LIMIT or before < 4 or any(n.op == "if" for n in postorder([formula])):
        return formula
    import sympy

    try:
        value = to_sympy(formula)
        candidates = [sympy.trigsimp(sympy.expand(value)), sympy.expand(value)]
        found = [from_sympy(c) for c in candidates]
    except (BridgeError, NotImplementedError):
        return formula
    best = min(found, key=lambda e: len(postorder([e])))
    return best if len(postorder([best])) < before else formula


def cancelled(coefficient: Expression) -> Expression:
    """A coefficient with quotients cancelled, where it has any and that makes it shorter: mu/(-rho/kappa)."""
    nodes = postorder([coefficient])
    rational = all(n.op in ("number", "symbol", "pi", "add", "mul", "pow") for n in nodes)
    quotients = sum(n.op == "pow" and n.args[1].is_number and float(n.args[1].value or 0) < 0 for n in nodes)
    if not rational or quotients < 2 or len(nodes) > LIMIT:
        return coefficient
    import sympy

    found = from_sympy(sympy.factor(sympy.cancel(sympy.together(to_sympy(coefficient)))))
    return found if len(postorder([found])) < len(nodes) else coefficient
