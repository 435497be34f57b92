"""An .ode file of XPPAUT -> a plain model document.

Parameters stay parameters; numbers, derived parameters (!name=...) and fixed quantities become definitions, auxiliary
quantities observables, named sets starts. Sources: "Structure of ODE files" and "Options" of XPPAUT's help, section
"ODE files" of its manual, and what XPPAUT 6.11 prints for files that the documentation leaves open (`grammar`).
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.exchange.imported import Imported, UnsupportedError
from contin.exchange.naming import Names, cleaned
from contin.exchange.xpp.declarations import Declared
from contin.exchange.xpp.declared import declared
from contin.exchange.xpp.document import Document, document
from contin.exchange.xpp.entries import Entry, circular, entry, reached
from contin.exchange.xpp.formulas import Formulas
from contin.exchange.xpp.lines import statements
from contin.exchange.xpp.run import run_of
from contin.exchange.xpp.statements import statement
from contin.exchange.xpp.symbols import Symbols

MOST_MESSAGES: Final = 8


def read(text: str, path: Path) -> Imported:
    """The model in an .ode file.

    Raises
    ------
    UnsupportedError
        It has delays, noise, tables, ...: every such line is named.
    """
    notes: list[str] = []
    try:
        found = declared([statement(line) for line in statements(text, notes)], notes)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    _refuse(found.missing, path)
    if not found.states:
        raise InputError(f"{path}: no differential equation and no map is found")
    symbols = _symbols(found, notes)
    is_map = found.is_map or found.options.discrete
    parts = _parts(found, symbols, is_map, notes)
    _refuse(parts.missing, path)
    model = document(found, parts, symbols, is_map)
    main = next(iter(found.parameters), None)
    autonomous = is_map or not parts.formulas.uses_time  # branches need the period of what depends on the time
    name = None if main is None or not autonomous else symbols.table[main.lower()].name
    heading = {"name": cleaned(path.stem), "source": f"XPPAUT file {path.name}"}
    return Imported({**heading, **model}, tuple(dict.fromkeys(notes)), run_of(found, name))


def _refuse(wrong: Iterable[str], path: Path) -> None:
    """One error with everything that stands in the way."""
    texts = list(dict.fromkeys(wrong))
    if texts:
        more = [f"... and {len(texts) - MOST_MESSAGES} more"] if texts[MOST_MESSAGES:] else []
        raise UnsupportedError("\n".join(f"{path}: {text}" for text in texts[:MOST_MESSAGES] + more))


def _symbols(found: Declared, notes: list[str]) -> Symbols:
    symbols = Symbols(Names(notes), notes)
    for formula in (*found.states, *found.algebraic):
        symbols.declare(formula.name, "state")
    for spelled in found.parameters:
        symbols.declare(spelled, "parameter")
    for spelled in found.numbers:
        symbols.declare(spelled, "number")
    for kind, formulas in (("derived", found.derived), ("fixed", found.fixed), ("function", found.functions)):
        for formula in formulas:
            symbols.declare(formula.name, kind)
    for spelled in found.noise:
        symbols.declare(spelled, "noise", "0")
    symbols.order = [f.name.lower() for f in (*found.states, *found.fixed)]
    symbols.constants = [spelled.lower() for spelled in (*found.parameters, *found.numbers)]
    return symbols


def _parts(found: Declared, symbols: Symbols, is_map: bool, notes: list[str]) -> Document:
    """The formulas read, sorted into those that are used, those that cannot be read, and those left out."""
    clock = symbols.names.take("step_number") if is_map else ""
    start = found.options.number("t0") or 0.0
    time = clock or ("t" if not start else f"(t {'+' if start > 0 else '-'} {abs(start)!r})")
    numbers = {name.lower(): value for name, value in found.numbers.items()}
    defaults = {name.lower(): value for name, value in found.parameters.items()}
    formulas = Formulas(symbols, time, numbers, defaults, notes)
    formulas.tables = {table.formula.name.lower(): table for table in found.tables}
    inner = [entry(f, formulas, symbols) for f in (*found.derived, *found.fixed, *found.functions)]
    table = {item.key: item for item in inner}
    states = [entry(f, formulas, symbols) for f in (*found.states, *found.algebraic)]
    resets = [
        (r.direction, entry(r.when, formulas, symbols), [entry(f, formulas, symbols) for f in r.jumps])
        for r in found.resets
    ]
    resetting = [item for _, when, jumps in resets for item in (when, *jumps)]
    used = reached([*states, *resetting], table)
    loops = circular(table)
    missing = [item.wrong for item in (*states, *resetting, *(table[key] for key in used)) if item.wrong]
    missing += _no_variables(found, symbols, is_map)
    missing += [
        f"line {f.line}: algebraic equations (0=) in a map have no equal here" for f in found.algebraic if is_map
    ]
    missing += [f"line {table[k].formula.line}: {k} depends on itself" for k in used & loops]
    _spread_noise(formulas, table)
    missing += [
        f"line {item.formula.line}: global with random numbers has no equal here"
        for item in resetting
        if item.tree is not None and formulas.has_noise(item.tree)
    ]
    missing += _noise(found, formulas, states, notes)
    good = {k: e for k, e in table.items() if not e.wrong and k not in loops and not reached([e], table) & loops}
    good = {k: e for k, e in good.items() if not any(table[u].wrong for u in reached([e], table))}
    for key in table.keys() - good.keys() - used:
        why = table[key].wrong or f"line {table[key].formula.line}: it depends on itself"
        notes.append(f"{key} is left out, which no equation uses; {why}")
    _later(found, table, notes)
    observed = _observed(found, formulas, symbols, good, notes)
    return Document(formulas, states, good, observed, tuple(missing), clock, start, tuple(resets))


def _no_variables(found: Declared, symbols: Symbols, is_map: bool) -> list[str]:
    """What stands in the way of resets: what they set is no variable, or the model is a map."""
    where = "in a map" if is_map else "beside algebraic equations (0=)"
    impossible = is_map or found.algebraic
    missing = [f"line {r.when.line}: global {where} has no equal here" for r in found.resets if impossible]
    for formula in (f for reset in found.resets for f in reset.jumps):
        symbol = symbols.table.get(symbols.full(formula.name.lower()))
        if symbol is None or symbol.kind != "state":
            what = f"global sets {formula.name}, which is no variable"
            missing.append(f"line {formula.line}: {what}: this has no equal here")
    return missing


def _observed(
    found: Declared, formulas: Formulas, symbols: Symbols, good: dict[str, Entry], notes: list[str]
) -> list[Entry]:
    """Auxiliary quantities that can be read."""
    kept: list[Entry] = []
    for formula in found.observed:
        item = entry(formula, formulas, symbols)
        lost = next((u for u in item.uses if (s := symbols.table.get(u)) and s.kind in _INNER and u not in good), None)
        why = item.wrong or (f"line {formula.line}: {lost} is left out" if lost else "")
        if not why and item.tree is not None and formulas.has_noise(item.tree):
            why = f"line {formula.line}: it contains noise"
        if why:
            notes.append(f"the auxiliary quantity {formula.name} is left out; {why}")
        else:
            kept.append(item)
    return kept


_INNER: Final = frozenset({"derived", "fixed", "function"})


def _spread_noise(formulas: Formulas, table: dict[str, Entry]) -> None:
    """Mark what contains noise, until nothing more does."""
    growing = bool(formulas.noisy)
    while growing:
        before = len(formulas.noisy)
        formulas.noisy |= {k for k, e in table.items() if e.tree is not None and formulas.has_noise(e.tree)}
        growing = len(formulas.noisy) > before


def _noise(found: Declared, formulas: Formulas, states: list[Entry], notes: list[str]) -> list[str]:
    """What stands in the way where noise drives a state; a note where its factor is zero."""
    driven = [e.formula for e in states if e.tree is not None and formulas.has_noise(e.tree)]
    names = ", ".join(found.noise)
    if not driven:
        if found.noise:
            line = min(found.noise.values())
            notes.append(f"line {line}: the noise {names} is left out: its factor is zero at the parameters' values")
        return []
    return [f"line {f.line}: {f.name} is driven by noise ({names}), which has no equal here" for f in driven]


def _later(found: Declared, table: dict[str, Entry], notes: list[str]) -> None:
    """XPP calculates fixed quantities in their order, and takes the last step's value of one that comes later."""
    for formulas in (found.fixed, found.derived):
        place = {f.name.lower(): i for i, f in enumerate(formulas)}
        for key, i in place.items():
            late = [u for u in table[key].uses if place.get(u, -1) > i]
            if late:
                notes.append(
                    f"line {table[key].formula.line}: {key} uses {', '.join(sorted(late))}, which is declared later: "
                    "XPP takes the value of the step before, here it is the present one"
                )
