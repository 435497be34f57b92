"""Numbers made of functions on an interval, in conditions and observables: u(start), u(end), integral(u^2), max(u).

Each becomes a symbol, named as it is written, that no formula can contain otherwise; `FunctionalReader.found` says what
it stands for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from contin.errors import ExpressionError
from contin.model.expression import Expression, number, symbol, symbols_in
from contin.model.inline import Formulas
from contin.model.parts import Condition, Functional
from contin.model.printing import to_text
from contin.model.scope import Calls, Scope
from contin.model.source import Path, Problems

if TYPE_CHECKING:
    from contin.model.model_parts import ModelParts

ENDS: Final = ("start", "end")
MEASURES: Final = ("integral", "mean", "norm", "max", "min")


class FunctionalReader:
    """Reads formulas with functionals of one model, whose independent variable is `time`."""

    def __init__(self, formulas: Formulas, states: Sequence[str], time: str, problems: Problems) -> None:
        self.formulas, self.problems, self.time = formulas, problems, time
        self.found: dict[str, Functional] = {}
        self._varying = {*states, time}
        names = dict(formulas.names)
        for name in (time, *ENDS):
            names.setdefault(name, symbol(name))
        calls: dict[str, Calls] = {name: self._end_value(name) for name in states}
        calls.update({name: self._measure(name) for name in MEASURES})
        self._scope = Scope(
            names, formulas.functions, formulas.conditions, formulas.unavailable, formulas.budget, calls
        )

    def number(self, value: object, path: Path) -> Expression:
        """A formula that is one number: functionals and parameters."""
        expression = self.formulas.read(value, path, self._scope)
        loose = next((name for name in symbols_in([expression]) if name in self._varying or name in ENDS), None)
        if loose is not None:
            what = (
                f"{loose} has a value everywhere on the interval: write {loose}(start), {loose}(end), "
                f"integral({loose}), mean({loose}), norm({loose}), max({loose}) or min({loose})"
                if loose not in ENDS
                else f"{loose} stands only in parentheses, as in u({loose})"
            )
            self.problems.add(path, what)
            return number(0)
        return expression

    def condition(self, text: str, path: Path) -> Condition:
        """LEFT = RIGHT, or an expression that vanishes."""
        before = len(self.problems.found)
        left, sign, right = text.partition("=")
        if right.startswith("=") or left.endswith(("<", ">", "!")):
            self.problems.add(path, "a condition is an equation with one `=`, such as u(start) = 0")
            return Condition(text, number(0))
        residual = self.number(left, path)
        if sign:
            residual = residual - self.number(right, path)
        plain = " ".join(text.split())
        kinds = {self.found[name].kind for name in symbols_in([residual]) if name in self.found}
        if not kinds and len(self.problems.found) == before:
            self.problems.add(path, "a condition must contain a value at an end, or an integral, of a state")
        if kinds & {"max", "min"}:
            self.problems.add(path, "max and min are no smooth conditions: give a value at an end, or an integral")
        return Condition(plain, residual)

    def _end_value(self, state: str) -> Calls:
        def read(arguments: Sequence[Expression], position: int) -> Expression:
            end = next((e for e in ENDS if len(arguments) == 1 and arguments[0] is symbol(e)), None)
            if end is None:
                raise ExpressionError(f"write {state}(start) or {state}(end), the value at one end", position)
            return self._known(f"{state}({end})", Functional(end, symbol(state)))

        return read

    def _measure(self, kind: str) -> Calls:
        def read(arguments: Sequence[Expression], position: int) -> Expression | None:
            if len(arguments) != 1:
                if kind in ("max", "min"):
                    return None
                raise ExpressionError(f"{kind} takes 1 argument, got {len(arguments)}", position)
            inside = next((n for n in symbols_in(arguments) if n in self.found or n in ENDS), None)
            if inside is not None:
                raise ExpressionError(f"{inside} is a number already; it cannot stand inside {kind}(...)", position)
            return self._known(f"{kind}({to_text(arguments[0])})", Functional(kind, arguments[0]))

        return read

    def _known(self, name: str, functional: Functional) -> Expression:
        self.found[name] = functional
        return symbol(name)


def condition_count(model: ModelParts, free: Sequence[str]) -> str:
    """What is wrong with the number of conditions, or of free parameters, in words."""
    states, conditions = len(model.states), len(model.conditions)
    needed = conditions - states
    if needed < 0:
        return (
            f"{model.name} has {conditions} conditions for {states} states: too few; a boundary-value problem needs "
            "as many conditions as states, and one more for each parameter under `free`"
        )
    if needed == 0:
        return (
            f"{model.name} has {conditions} conditions for {states} states, so no parameter is solved for beside the "
            f"one that varies: leave out `free` ({', '.join(free)}), or add a condition"
        )
    return (
        f"{model.name} has {conditions} conditions for {states} states, so {needed} "
        f"parameter{'s' * (needed != 1)} must be solved for beside the one that varies: write "
        f"`free: [{', '.join('...' for _ in range(needed))}]`; given: {', '.join(free) or 'none'}"
    )

