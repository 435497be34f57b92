"""Conserved totals of a reduced model: what a start in all states means for it, and what to say of them."""

from __future__ import annotations

from collections.abc import Sequence

from contin.model.expression import add, mul, symbol
from contin.model.parts import Start, State, Total
from contin.model.printing import to_text


def with_totals(start: Start, states: Sequence[State], totals: Sequence[Total]) -> Start:
    """A start that may give eliminated states, as one in the states that are left and in the totals.

    Where it gives a state of a law, and not the law's total, that is the sum over the start.
    """
    if not totals or not start.states:
        return start
    values = {s.name: s.value for s in (*states, *(t.state for t in totals))} | dict(start.states)
    parameters = dict(start.parameters)
    for t in totals:
        if t.name not in parameters and any(name in start.states for name in t.law):
            parameters[t.name] = add(*(mul(c, values[name]) for name, c in t.law.items()))
    eliminated = {t.state.name for t in totals}
    return Start(start.name, {n: v for n, v in start.states.items() if n not in eliminated}, parameters)


def total_lines(totals: Sequence[Total]) -> list[str]:
    """One line for each total, in words."""
    found = []
    for t in totals:
        law = to_text(add(*(mul(c, symbol(name)) for name, c in t.law.items())))
        note = f" ({t.note})" if t.note else ""
        found.append(
            f"{law} is conserved{note}: it is the parameter {t.name}, and {t.state.name} follows from it "
            "(a column, not an unknown)"
        )
    return found
