"""The model document of an .ode file, from its formulas."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from contin.exchange.naming import cleaned, label
from contin.exchange.xpp.declarations import Declared
from contin.exchange.xpp.entries import Entry
from contin.exchange.xpp.formulas import Formulas
from contin.exchange.xpp.run import parameter_ranges
from contin.exchange.xpp.symbols import Symbols
from contin.records import Fields


@dataclass(frozen=True)
class Document:
    """What the document is made of: `inner` are derived parameters, fixed quantities and functions by their names in
    small letters; `clock` the state that counts the steps of a map, from `start`."""

    formulas: Formulas
    states: list[Entry]
    inner: Mapping[str, Entry]
    observed: list[Entry]
    missing: tuple[str, ...]
    clock: str
    start: float
    resets: tuple[tuple[str, Entry, list[Entry]], ...] = ()  # direction, what crosses zero, new values

    def text(self, item: Entry) -> str:
        """A formula in contin's grammar."""
        return "0" if item.tree is None else self.formulas.text(item.tree, item.formula.arguments)


def document(found: Declared, parts: Document, symbols: Symbols, is_map: bool) -> Fields:
    """The entries of a model file."""
    equations = {symbols.table[e.key].name: parts.text(e) for e in parts.states}
    functions: dict[str, str] = {}
    definitions: dict[str, float | str] = {symbols.table[n.lower()].name: v for n, v in found.numbers.items()}
    for key, item in parts.inner.items():
        name = symbols.table[key].name
        if symbols.table[key].kind == "function":
            functions[f"{name}({', '.join(cleaned(a.lower()) for a in item.formula.arguments)})"] = parts.text(item)
        else:
            definitions[name] = parts.text(item)
    observables = _observables(parts, symbols, definitions)
    states = _states(found, symbols)
    notes = parts.formulas.notes
    if is_map and parts.formulas.uses_time:
        states[parts.clock] = parts.start
        equations[parts.clock] = f"{parts.clock} + 1"
        notes.append(f"the state {parts.clock} counts the steps, which XPP calls t")
    if found.boundary:
        lines = ", ".join(str(n) for n in found.boundary)
        notes.append(
            f"the boundary conditions on lines {lines} are left out: this is the initial value problem; for theirs "
            "write kind: bvp and conditions"
        )
    sections: Fields = {
        "kind": "map" if is_map else "flow",
        "states": states,
        "parameters": _parameters(found, symbols),
        "functions": functions,
        "definitions": definitions,
        "mass": {symbols.table[f.name.lower()].name: 0 for f in found.algebraic},
        "equations": equations,
        "events": [
            {
                "when": parts.text(when), "direction": direction,
                "set": {symbols.table[symbols.full(e.key)].name: parts.text(e) for e in jumps},
            }
            for direction, when, jumps in parts.resets
        ],
        "observables": observables,
        "starts": _starts(found, symbols),
    }
    return {key: value for key, value in sections.items() if value}


def _states(found: Declared, symbols: Symbols) -> Fields:
    values = dict.fromkeys((f.name.lower() for f in found.states), 0.0)
    values.update((name.lower(), value) for name, value in found.solved)
    for spelled, value in found.initial:
        key = symbols.full(spelled.lower())
        if key in values:
            values[key] = value
        else:
            symbols.notes.append(f"the initial value of {spelled}, which is no variable, is left out")
    period = found.options.number("tor_per")
    angles = {name.lower() for name in found.options.fold} if period else set()
    return {
        symbols.table[key].name: {"value": value, "period": period} if key in angles else value
        for key, value in values.items()
    }


def _parameters(found: Declared, symbols: Symbols) -> Fields:
    ranges = parameter_ranges(found)
    entries = Fields()
    for spelled, value in found.parameters.items():
        ends = ranges.get(spelled.lower())
        entries[symbols.table[spelled.lower()].name] = value if ends is None else {"value": value, "range": list(ends)}
    return entries


def _observables(parts: Document, symbols: Symbols, definitions: Mapping[str, object]) -> Fields:
    """Auxiliary quantities; one may have the name of a definition only where it is that."""
    entries = Fields()
    for item in parts.observed:
        text = parts.text(item)
        name = cleaned(item.formula.name)
        same = next((d for d in definitions if d.lower() == name.lower()), None)
        if same is not None and text == same and same not in entries:
            name = same
        else:
            name = symbols.names.take(item.formula.name)
        entries[name] = text
    return entries


def _starts(found: Declared, symbols: Symbols) -> Fields:
    """Named sets, as far as they set states and parameters."""
    starts = Fields()
    for spelled, items in found.sets.items():
        entry, own = Fields(), Fields()
        for name, value in items:
            symbol = symbols.find(name.lower())
            if symbol is not None and symbol.kind == "state":
                entry[symbol.name] = value
            elif symbol is not None and symbol.kind == "parameter":
                own[symbol.name] = value
        if own:
            entry["parameters"] = own
        if entry:
            starts[label(spelled)] = entry
    return starts
