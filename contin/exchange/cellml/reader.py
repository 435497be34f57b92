"""CellML text -> a plain model document, through Myokit, which joins components and converts units between them.

States are the variables with a differential equation, parameters those with a plain value, all others definitions;
each has its own name, with that of its component in front where two components use it.
"""

from __future__ import annotations

import re
import warnings
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.exchange.cellml.clocks import clocks, unit_names
from contin.exchange.cellml.formulas import tree
from contin.exchange.cellml.library import myokit, v1, v2
from contin.exchange.formulas.contin_text import Writer
from contin.exchange.formulas.functions import unknown
from contin.exchange.formulas.parser import FormulaError
from contin.exchange.formulas.tree import Node, number
from contin.exchange.imported import Imported, UnsupportedError
from contin.exchange.naming import Names, cleaned
from contin.exchange.xml_text import check

_VERSION: Final = re.compile(r"http://www\.cellml\.org/cellml/(\d)\.(\d)#")


def read(text: str, path: Path) -> Imported:
    """The model in a CellML document.

    Raises
    ------
    InputError
        The document is wrong.
    UnsupportedError
        It uses what contin has no equal for.
    """
    bare = check(text, path)
    version = _VERSION.search(bare)
    if version is None:
        raise InputError(f"{path}: is no CellML document (its namespace is not http://www.cellml.org/cellml/...)")
    digit = int(version[1])
    parser = (v2 if digit == 2 else v1).CellMLParser()
    try:
        found = parser.parse_string(bare)
        found.validate()
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            model = found.myokit_model()
        return _imported(model, clocks(found, digit), unit_names(found), path, [str(w.message) for w in said])
    except FormulaError as error:
        raise UnsupportedError(f"{path}: {error}") from None
    except (myokit.MyokitError, v1.CellMLError, v2.CellMLError, v1.CellMLParsingError, v2.CellMLParsingError) as error:
        raise UnsupportedError(f"{path}: {error}") from None


def _imported(
    model: myokit.Model, factors: Mapping[str, float], units: Mapping[str, str], path: Path, said: list[str]
) -> Imported:
    notes: list[str] = []
    if any("conversion factor" in text for text in said):
        raise FormulaError(next(text for text in said if "conversion factor" in text))
    notes += said
    names = Names(notes)
    variables = list(model.variables(deep=True, sort=False))
    states = list(model.states())
    time = model.time()
    called = _called([v for v in (*states, *variables) if v is not time], names)
    if time is not None:
        called[time.qname()] = "t"
    writer = Writer(lambda key: called[key], {}, unknown)
    inner = [v for v in variables if not v.is_state() and v is not time]
    values = model.initial_values(as_floats=True)
    sections = {
        "states": {
            called[v.qname()]: _entry(float(x), units.get(v.qname())) for v, x in zip(states, values, strict=True)
        },
        "parameters": {called[v.qname()]: _entry(v.eval(), units.get(v.qname())) for v in inner if v.is_literal()},
        "definitions": {called[v.qname()]: writer.number(tree(v.rhs())) for v in inner if not v.is_literal()},
        "equations": {called[v.qname()]: writer.number(_rate(v, factors)) for v in states},
    }
    if not states:
        raise UnsupportedError(f"{path}: it has no differential equation")
    heading = {"name": cleaned(path.stem), "title": model.name() or path.stem, "source": f"CellML file {path.name}"}
    return Imported({**heading, **{k: v for k, v in sections.items() if v}}, tuple(notes))


def _rate(state: myokit.Variable, factors: Mapping[str, float]) -> Node:
    """The derivative with respect to the model's time; components may measure it in other units."""
    factor = factors.get(state.parent().name(), 1.0)
    return tree(state.rhs()) if factor == 1.0 else Node("*", (number(factor), tree(state.rhs())))


def _called(variables: list[myokit.Variable], names: Names) -> dict[str, str]:
    """What variables are called here, by their full names: a state has its own name, where no other state has it."""
    unique = {v.qname(): v for v in variables}
    states = Counter(v.name() for v in unique.values() if v.is_state())
    shared = Counter(v.name() for v in unique.values())

    def wanted(v: myokit.Variable) -> str:
        alone = states[v.name()] == 1 if v.is_state() else shared[v.name()] == 1
        return str(v.name() if alone else v.qname().replace(".", "_"))

    return {key: names.take(wanted(v), quiet=True) for key, v in unique.items()}


def _entry(value: float, unit: str | None) -> float | Mapping[str, float | str]:
    return float(value) if unit is None else {"value": float(value), "unit": unit}
