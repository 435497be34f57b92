"""A system file of MatCont or MatContM -> a plain model document.

Read is `fun_eval(t, kmrgd, parameters ...)`: assignments and the vector dydt; from `init` the vector y0. The files hold
no values of parameters and no names of coordinates; a comment `% par_a = 1.5` gives a value, an assignment
`x = kmrgd(1)` a name, a comment `% map` says that the system is a map. contin's own exports have all of them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.exchange.assignments import Assignments, element
from contin.exchange.formulas.functions import MATLAB, unknown
from contin.exchange.formulas.parser import Binary, Dialect, FormulaError, Prefix, parse
from contin.exchange.formulas.tree import COMPARISONS, Node
from contin.exchange.imported import Imported, UnsupportedError
from contin.exchange.naming import Names, cleaned

DIALECT: Final = Dialect(
    tokens=re.compile(
        r"(?P<space>\s+)|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)"
        r"|(?P<op>\.\*|\./|\.\^|<=|>=|==|~=|&&|\|\||[-+*/^<>&|~(),])",
        re.ASCII,
    ),
    binary={
        **{op: Binary(1, "or") for op in ("|", "||")},
        **{op: Binary(2, "and") for op in ("&", "&&")},
        **{op: Binary(3, op) for op in COMPARISONS if op != "!="},
        "~=": Binary(3, "!="),
        **{op: Binary(4, op) for op in "+-"},
        **{op: Binary(5, op[-1]) for op in ("*", "/", ".*", "./")},
        **{op: Binary(7, "^") for op in ("^", ".^")},
    },
    prefix={"-": Prefix(6, "neg"), "+": Prefix(6, ""), "~": Prefix(6, "not")},
    fold=False,
)
_CONTINUED: Final = re.compile(r"\.\.\.[^\n]*\n")
_FUNCTION: Final = re.compile(r"^\s*function\b", re.MULTILINE)
_HANDLE: Final = re.compile(r"\bout\{\s*2\s*\}\s*=\s*@(\w+)")
_EVALUATED: Final = re.compile(r"\s*function\s+(\w+)\s*=\s*(\w+)\s*\(([^)]*)\)(.*)", re.DOTALL)
_INITIAL: Final = re.compile(r"\by0\s*=\s*\[([^\]]*)\]")
_VALUE: Final = re.compile(r"^\s*%\s*(\w+)\s*=\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*$", re.MULTILINE)
_CONTROL: Final = re.compile(r"(if|for|while|switch|try|parfor|global|persistent|end|else|return)\b")
_ASSIGNED: Final = re.compile(r"([A-Za-z_]\w*)\s*(\([^()]*\))?\s*=(?!=)(.*)", re.DOTALL)


def read(text: str, path: Path) -> Imported:
    """The model in a MatCont system file."""
    text = _CONTINUED.sub(" ", text)
    handle = _HANDLE.search(text)
    wanted = "fun_eval" if handle is None else handle[1]
    parts = [text[m.start() : n] for m, n in _pairs(list(_FUNCTION.finditer(text)), len(text))]
    found = next((m for part in parts if (m := _EVALUATED.match(part)) and m[2] == wanted), None)
    if found is None:
        raise InputError(f"{path}: there is no function dydt = {wanted}(t, kmrgd, ...): not a MatCont system file")
    arguments = [a.strip() for a in found[3].split(",")]
    if len(arguments) < 2:
        raise InputError(f"{path}: fun_eval takes the time, the coordinates and the parameters")
    try:
        return _imported(text, path, found[1], arguments, found[4])
    except FormulaError as error:
        raise UnsupportedError(f"{path}: {error}") from None


def _pairs(starts: list[re.Match[str]], end: int) -> Iterator[tuple[re.Match[str], int]]:
    yield from zip(starts, [*(m.start() for m in starts[1:]), end], strict=False)


def _imported(text: str, path: Path, result: str, arguments: list[str], body: str) -> Imported:
    notes: list[str] = []
    names = Names(notes)
    time, vector, *parameters = arguments
    statements = list(_statements(body))
    rows = next((_rows(value) for name, index, value in statements if name == result and not index), None)
    if rows is None:
        raise InputError(f"{path}: fun_eval does not assign {result} = [...]")
    values = {name: float(value) for name, value in _VALUE.findall(text)}
    prefix = "par_" if parameters and all(p.startswith("par_") for p in parameters) else ""
    called = {p: names.take(p.removeprefix(prefix)) for p in parameters}
    unvalued = [p for p in parameters if p not in values]
    if unvalued:
        notes.append(f"the file holds no values of parameters: {', '.join(called[p] for p in unvalued)} are 0 here")
    states = _state_names(statements, vector, len(rows), names)
    program = Assignments(names, MATLAB, unknown, {time: "t", "pi": "pi"}, dict(called))
    program.elements = {(vector, i): name for i, name in enumerate(states, 1)}
    for name, index, value in statements:
        if name == result and not index:
            break
        if index:
            raise UnsupportedError(f"{path}: {name}{index} = ...: arrays are not read")
        program.assign(name, parse(value, DIALECT))
    equations = {state: program.text(parse(row, DIALECT)) for state, row in zip(states, rows, strict=True)}
    sections = {
        "kind": "map" if re.search(r"^\s*%\s*map\b", text, re.MULTILINE) else "flow",
        "states": dict(zip(states, _initial(text, len(states), notes), strict=True)),
        "parameters": {called[p]: values.get(p, 0.0) for p in parameters},
        "definitions": program.definitions,
        "equations": equations,
    }
    heading = {"name": cleaned(path.stem), "source": f"MatCont system file {path.name}"}
    return Imported({**heading, **{k: v for k, v in sections.items() if v}}, tuple(notes))


def _statements(body: str) -> Iterator[tuple[str, str, str]]:
    """Assignments (variable, index in parentheses or nothing, formula)."""
    text = re.sub(r"%[^\n]*", "", body)
    for statement in _split(text, ";\n"):
        if not statement or re.fullmatch(r"end(function)?", statement):
            continue
        if _CONTROL.match(statement):
            raise FormulaError(f"{statement.split()[0]!r}: fun_eval is read only where it is assignments")
        found = _ASSIGNED.fullmatch(statement)
        if found is None:
            raise FormulaError(f"{statement[:60]!r} is no assignment")
        yield found[1], found[2] or "", found[3].strip()


def _split(text: str, separators: str) -> Iterator[str]:
    """Parts between separators that stand outside of brackets."""
    depth, start = 0, 0
    for i, letter in enumerate(text):
        depth += (letter in "([{") - (letter in ")]}")
        if letter in separators and depth <= 0:
            yield text[start:i].strip()
            start = i + 1
    yield text[start:].strip()


def _rows(value: str) -> list[str]:
    inner = value.strip()
    if not (inner.startswith("[") and inner.endswith("]")):
        return [inner]
    return [row for row in _split(inner[1:-1], ";\n") if row]


def _state_names(statements: list[tuple[str, str, str]], vector: str, count: int, names: Names) -> list[str]:
    """Names of the coordinates: those of variables that are set to them, else x1, x2, ..."""
    found: dict[int, str] = {}
    for name, index, value in statements:
        try:
            node = parse(value, DIALECT) if not index and not value.startswith("[") else Node("")
        except FormulaError:
            continue
        place = element(node) if node.text == vector else None
        if place is not None:
            found.setdefault(place, name)
    return [names.take(found.get(i, f"x{i}" if count > 1 else "x")) for i in range(1, count + 1)]


def _initial(text: str, count: int, notes: list[str]) -> list[float]:
    found = _INITIAL.search(text)
    numbers = [] if found is None else re.split(r"[,;\s]+", found[1].strip())
    try:
        values = [float(v) for v in numbers]
    except ValueError:
        values = []
    if len(values) != count:
        notes.append("the file holds no values of the coordinates: they are 0 here")
        return [0.0] * count
    return values
