"""Which names may be declared, and that no name is declared twice."""

from __future__ import annotations

import re

from contin.model.inline import HEADING
from contin.model.lexer import RESERVED, canonical_name, is_name
from contin.model.parts import TAKEN_NAMES
from contin.model.schema import ModelEntry
from contin.model.source import Path, Problems


def check_names(entry: ModelEntry, problems: Problems) -> None:
    """Names of states, parameters, functions and definitions are one namespace; observables share only the columns
    with states and parameters, so a definition may be observed under its own name; so may a parameter, as itself."""
    declared: dict[str, str] = {}
    for section in ("states", "parameters", "functions", "definitions"):
        for key in getattr(entry, section):
            name = canonical_name(key)
            if section == "functions":
                heading = HEADING.fullmatch(key)
                if heading is None:
                    continue  # noted where the heading is read
                name = canonical_name(heading.group(1))
            if not check_name(name, (section, key), problems):
                continue
            if name in declared:
                problems.add((section, key), f"{name} is already declared under {declared[name]}", key=True)
            declared.setdefault(name, section)
    columns: dict[str, str] = {n: s for n, s in declared.items() if s in ("states", "parameters")}
    for key in entry.observables:
        name = canonical_name(key)
        itself = columns.get(name) == "parameters" and str(entry.observables[key]).strip() == key
        if check_name(name, ("observables", key), problems) and name in columns and not itself:
            problems.add(("observables", key), f"{name} is already declared under {columns[name]}", key=True)
        columns.setdefault(name, "observables")


def check_name(name: str, path: Path, problems: Problems) -> bool:
    """Whether `name` may be declared; what is wrong with it is noted."""
    if name in RESERVED:
        problems.add(path, f"{name!r} is a word of the formula language; choose another name", key=True)
    elif name in TAKEN_NAMES:
        problems.add(path, f"{name!r} is taken (a column or key of the results); choose another name", key=True)
    elif "." in name:
        problems.add(path, f"names may not contain a dot; write {name.replace('.', '_')}", key=True)
    elif not is_name(name):
        suggestion = re.sub(r"\W", "_", name)
        suggestion = f"_{suggestion}" if suggestion[:1].isdigit() else suggestion
        advice = f"; write {suggestion}" if is_name(suggestion) and suggestion.strip("_") else ""
        problems.add(
            path, f"{name!r} is not a name: letters, digits and underscores, not a digit first{advice}", key=True
        )
    else:
        return True
    return False


def check_label(name: str, path: Path, problems: Problems) -> None:
    """Names of starts and symmetries become parts of branch names (in-phase/BP1, fork~flip, line.HB1)."""
    if not name.strip() or not name.isprintable() or any(c in name for c in "./~"):
        problems.add(path, f"{name!r} cannot name a branch: leave out dots, '/' and '~'", key=True)
