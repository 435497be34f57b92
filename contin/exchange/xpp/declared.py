"""Statements of an .ode file -> what they declare."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Final

from contin.exchange.xpp.constants import leading_number
from contin.exchange.xpp.declarations import Declared, Formula, Reset, Table
from contin.exchange.xpp.lines import INTEGRAL
from contin.exchange.xpp.options import read_options
from contin.exchange.xpp.statements import Statement, values

_TABLE: Final = re.compile(r"(\S+)\s+%\s*(\d+)\s+(\S+)\s+(\S+)\s+(.*)", re.DOTALL)
_SET: Final = re.compile(r"(\S+)\s*\{(.*?)\}?\s*", re.DOTALL)
_GLOBAL: Final = re.compile(r"([-+]?\d+)\s+(.*?)\s*\{(.*?)\}?\s*", re.DOTALL)
_FUNCTION: Final = re.compile(r"\(([^()]*)\)\s*=(.*)", re.DOTALL)

# statements whose feature contin has no equal for
MISSING: Final = {
    "volterra": "Volterra integral equations",
    "markov": "Markov variables",
    "special": "networks by table (special)",
    "export": "right-hand sides in a library of their own (export)",
    "chemistry": "solution chemistry (pHtools)",
}


def declared(statements: list[Statement], notes: list[str]) -> Declared:
    """Everything that the statements declare."""
    found = Declared(notes=notes)
    for item in statements:
        if item.kind != "set" and INTEGRAL.search(item.text):
            found.missing.append(f"line {item.line}: {MISSING['volterra']} have no equal here")
        elif item.kind in MISSING:
            found.missing.append(f"line {item.line}: {MISSING[item.kind]} have no equal here")
        elif item.kind in _READ:
            _READ[item.kind](found, item)
        elif item.text:
            notes.append(f"line {item.line}: {item.name!r} is no declaration of XPP's; it is passed over, as XPP does")
    _pair(found)
    for kind, formulas in (
        ("equation", [*found.states, *found.algebraic]),
        ("quantity", [*found.fixed, *found.derived]),
    ):
        seen: dict[str, int] = {}
        for formula in formulas:
            if formula.name.lower() in seen:
                first = seen[formula.name.lower()]
                found.missing.append(f"line {formula.line}: a second {kind} for {formula.name}, as on line {first}")
            seen.setdefault(formula.name.lower(), formula.line)
    return found


def _pair(found: Declared) -> None:
    """One variable of solve for each 0= equation: they determine each other together, in any order."""
    if len(found.algebraic) != len(found.solved):
        found.missing.append(f"{len(found.algebraic)} equations 0=, but {len(found.solved)} variables in solve")
        return
    found.algebraic = [
        replace(formula, name=name) for formula, (name, _) in zip(found.algebraic, found.solved, strict=True)
    ]


def _algebraic(found: Declared, item: Statement) -> None:
    found.algebraic.append(Formula(item.line, "0", item.text))


def _solve(found: Declared, item: Statement) -> None:
    found.solved += [(name, _value(found, item.line, name, text)) for name, text in values(item.text)]


def _equation(found: Declared, item: Statement) -> None:
    found.states.append(Formula(item.line, item.name, item.text))
    found.is_map = found.is_map or item.kind == "map"


def _function(found: Declared, item: Statement) -> None:
    form = _FUNCTION.fullmatch(item.text)
    if form is None:
        return
    arguments = tuple(arg.strip() for arg in form[1].split(","))
    found.functions.append(Formula(item.line, item.name, form[2].strip(), arguments))


def _table(found: Declared, item: Statement) -> None:
    form = _TABLE.fullmatch(item.text)
    if form is None or int(form[2]) < 2:
        found.missing.append(f"line {item.line}: tables from files have no equal here")
        return
    (low, good), (high, fine) = leading_number(form[3]), leading_number(form[4])
    if not (good and fine and low < high):
        found.missing.append(f"line {item.line}: the table {form[1]} needs two ends that are numbers")
        return
    found.tables.append(Table(Formula(item.line, form[1], form[5].strip(), ("t",)), int(form[2]), low, high))


def _global(found: Declared, item: Statement) -> None:
    """global sign condition {name=formula; ...}"""
    form = _GLOBAL.fullmatch(item.text)
    sets = [part.partition("=") for part in form[3].split(";") if part.strip()] if form is not None else []
    if form is None or not sets or not all(equals for _, equals, _ in sets):
        found.missing.append(f"line {item.line}: global is read as `global 1 v-1 {{v=0; u=u+d}}`")
        return
    if int(form[1]) == 0:
        found.missing.append(f"line {item.line}: global with the sign 0 has no equal here: write 1 (up) or -1 (down)")
        return
    when = Formula(item.line, f"global on line {item.line}", form[2])
    jumps = [Formula(item.line, name.strip(), text.strip()) for name, _, text in sets]
    found.resets.append(Reset("up" if int(form[1]) > 0 else "down", when, tuple(jumps)))


def _numbers(kind: str) -> Callable[[Declared, Statement], None]:
    def read(found: Declared, item: Statement) -> None:
        table = found.parameters if kind == "parameter" else found.numbers
        for name, text in values(item.text):
            if any(name.lower() == other.lower() for other in (*found.parameters, *found.numbers)):
                found.missing.append(f"line {item.line}: {name} is declared a second time")
                continue
            table[name] = _value(found, item.line, name, text)

    return read


def _value(found: Declared, line: int, name: str, text: str) -> float:
    value, whole = leading_number(text)
    if not whole:
        found.notes.append(
            f"line {line}: XPP reads {name} = {text} as {value:g}, the number it begins with, and so does this import"
        )
    return value


def _initial(found: Declared, item: Statement) -> None:
    """init x=1, y=2."""
    found.initial += [(name, _value(found, item.line, name, text)) for name, text in values(item.text)]


def _initial_one(found: Declared, item: Statement) -> None:
    """x(0)=1."""
    found.initial.append((item.name, _value(found, item.line, f"{item.name}(0)", item.text)))


def _aux(found: Declared, item: Statement) -> None:
    name, equals, text = item.text.partition("=")
    if equals:
        found.observed.append(Formula(item.line, name.strip(), text.strip()))


def _set(found: Declared, item: Statement) -> None:
    form = _SET.fullmatch(item.text)
    if form is None:
        return
    chosen = [(name, leading_number(text)) for name, text in values(form[2])]
    found.sets[form[1]] = [(name, value) for name, (value, whole) in chosen if whole]


def _noise(found: Declared, item: Statement) -> None:
    for name, _ in values(item.text):
        found.noise[name] = item.line


def _boundary(found: Declared, item: Statement) -> None:
    found.boundary.append(item.line)


def _options(found: Declared, item: Statement) -> None:
    read_options(item.text, found.options)


def _file(found: Declared, item: Statement) -> None:
    found.notes.append(f"line {item.line}: the options in the file {item.text} are not read")


def _formula(kind: str) -> Callable[[Declared, Statement], None]:
    def read(found: Declared, item: Statement) -> None:
        (found.fixed if kind == "fixed" else found.derived).append(Formula(item.line, item.name, item.text))

    return read


def _nothing(found: Declared, item: Statement) -> None:
    """What says only how XPP shows or saves."""


_READ: Final[dict[str, Callable[[Declared, Statement], None]]] = {
    "equation": _equation,
    "map": _equation,
    "algebraic": _algebraic,
    "solve": _solve,
    "function": _function,
    "fixed": _formula("fixed"),
    "derived": _formula("derived"),
    "initial": _initial,
    "initial value": _initial_one,
    "table": _table,
    "aux": _aux,
    "parameter": _numbers("parameter"),
    "number": _numbers("number"),
    "set": _set,
    "wiener": _noise,
    "global": _global,
    "boundary": _boundary,
    "options": _options,
    "options file": _file,
    "only": _nothing,
}
