"""An equations file of AUTO-07p (FUNC, STPNT), with its constants beside it -> a plain model document.

Read are straight programs: assignments to local variables and to F. What follows a test of IJAC is the Jacobian, which
contin derives. Source: "AUTO-07p: continuation and bifurcation software for ordinary differential equations", sections
on user-supplied files and on constants.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.exchange.assignments import Assignments, element
from contin.exchange.auto.assigned import Assigned, assigned, inserted
from contin.exchange.auto.constants import Constants, beside
from contin.exchange.auto.run import run_of
from contin.exchange.auto.source import Subroutine, subroutines
from contin.exchange.formulas.functions import FORTRAN, unknown
from contin.exchange.formulas.parser import FormulaError
from contin.exchange.formulas.tree import walk
from contin.exchange.imported import Imported, UnsupportedError
from contin.exchange.naming import Names, cleaned
from contin.model.evaluate import evaluate
from contin.model.parser import parse as parse_formula

KINDS: Final = {-1: "map", 0: "algebraic", 1: "flow", 2: "flow", -2: "flow", 3: "flow"}


def read(text: str, path: Path) -> Imported:
    """The model in an equations file of AUTO."""
    parts = subroutines(text)
    if "func" not in parts or len(parts["func"].arguments) < 6:
        raise InputError(f"{path}: there is no SUBROUTINE FUNC(NDIM,U,ICP,PAR,IJAC,F,...): no equations file of AUTO")
    found = beside(path)
    if found.kind not in KINDS:
        problem = {4: "a boundary-value problem", 7: "a boundary-value problem", 9: "connecting orbits"}
        what = problem.get(found.kind, "of a kind that is not read")
        raise UnsupportedError(f"{path}: its constants say IPS = {found.kind}, {what}")
    try:
        return _imported(parts, found, path)
    except FormulaError as error:
        raise UnsupportedError(f"{path}: {error}") from None


def _imported(parts: dict[str, Subroutine], found: Constants, path: Path) -> Imported:
    notes: list[str] = []
    if not found.known:
        notes.append(f"there is no file of constants c.{path.stem} beside it: it is read as a flow")
    func = parts["func"]
    _, vector, _, par, _, right = func.arguments[:6]
    rows = assigned(func, notes)
    sizes = [a.index for a in rows if a.variable == right and a.index is not None]
    if not sizes:
        raise FormulaError("FUNC assigns no F(1) = ...")
    start = _starting(parts.get("stpnt"), max(sizes), notes)
    used = _indices(rows, par) | found.parameters.keys()
    idle = sorted(start.parameters.keys() - used)
    if idle:
        notes.append(f"left out, for FUNC does not use them: {', '.join(f'PAR({i})' for i in idle)}")
    names = Names(notes)
    states = _called(range(1, max(sizes) + 1), vector, found.states, rows, names, "u")
    parameters = _called(sorted(used), par, found.parameters, rows, names, "par")
    program = Assignments(names, FORTRAN, unknown)
    program.elements = {(vector, i): n for i, n in states.items()} | {(par, i): n for i, n in parameters.items()}
    equations: dict[int, str] = {}
    for item in rows:
        try:
            if item.variable == right and item.index is not None:
                equations[item.index] = program.text(item.node)
                program.elements[(right, item.index)] = f"({equations[item.index]})"
            elif item.arguments:
                program.calls = {**program.calls, item.variable: inserted(item)}
            elif item.index is not None:
                raise FormulaError(f"{item.variable}({item.index}) = ...: arrays of its own are not read")
            else:
                program.assign(item.variable, item.node)
        except FormulaError as error:
            raise FormulaError(f"line {item.line}: {error}") from None
    missing = [i for i in states if i not in equations]
    if missing:
        raise FormulaError(f"FUNC assigns no F({missing[0]})")
    kind = KINDS[found.kind]
    sections = {
        "kind": kind,
        "states": {n: start.states.get(i, 0.0) for i, n in states.items()},
        "parameters": {n: start.parameters.get(i, 0.0) for i, n in parameters.items()},
        "definitions": program.definitions,
        "equations": {n: equations[i] for i, n in states.items()},
    }
    heading = {"name": cleaned(path.stem), "source": f"AUTO equations file {path.name}"}
    model = {**heading, **{k: v for k, v in sections.items() if v}}
    return Imported(model, tuple(dict.fromkeys(notes)), run_of(found, parameters))


def _indices(rows: list[Assigned], array: str) -> set[int]:
    """Which elements of an array occur in formulas."""
    return {i for a in rows for n in walk(a.node) if n.text == array and (i := element(n)) is not None}


def _called(
    indices: range | list[int], array: str, given: dict[int, str], rows: list[Assigned], names: Names, stem: str
) -> dict[int, str]:
    """Names of array elements: those of the constants, else of a variable that is set to them, else u1, par1, ..."""
    local: dict[int, str] = {}
    for item in rows:
        place = element(item.node) if item.node.text == array and item.index is None else None
        if place is not None:
            local.setdefault(place, item.variable)
    return {i: names.take(given.get(i) or local.get(i) or f"{stem}{i}") for i in indices}


@dataclass(frozen=True)
class Starting:
    """What STPNT sets."""

    states: dict[int, float]
    parameters: dict[int, float]


def _starting(routine: Subroutine | None, size: int, notes: list[str]) -> Starting:
    """The values of STPNT; those that it takes from what cannot be known here are 0, with a note."""
    values = Starting({}, {})
    if routine is None or len(routine.arguments) < 3:
        notes.append("there is no STPNT: all states and parameters are 0 here")
        return values
    _, vector, par = routine.arguments[:3]
    time = dict.fromkeys(routine.arguments[3:4], "0")
    if time and any(n.text in time for item in assigned(routine, []) for n in walk(item.node)):
        notes.append("STPNT is read at T = 0")
    program = Assignments(Names([]), FORTRAN, unknown, time)
    constants: dict[str, float] = {}
    for item in assigned(routine, notes):
        if item.arguments:
            program.calls = {**program.calls, item.variable: inserted(item)}
            continue
        value = float(evaluate(parse_formula(program.text(item.node), list(constants)), constants))
        name = f"v{len(constants)}"
        constants[name] = value
        if item.index is None and item.variable not in (vector, par):
            program.current[item.variable] = name
            continue
        target = values.states if item.variable == vector else values.parameters if item.variable == par else {}
        for i in range(1, size + 1) if item.index is None else [item.index]:
            program.elements[(item.variable, i)] = name
            target[i] = value
    return values
