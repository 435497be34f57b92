"""Is a document what its schema says? The part of JSON Schema that our schemas use, without a library for it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.records import Json, Record
from contin.store.result_schema import RESULT_SCHEMA

_TYPES: Final[Mapping[str, frozenset[type]]] = {
    "number": frozenset({int, float}),
    "integer": frozenset({int}),
    "string": frozenset({str}),
    "boolean": frozenset({bool}),
    "null": frozenset({type(None)}),
    "object": frozenset({dict}),
    "array": frozenset({list}),
}
LARGEST: Final = 10**300  # integers beyond have no floating-point form
Mistake = tuple[str, str]  # where, what


def validate(document: Record, path: Path) -> None:
    """Raise InputError with the first place where a result document does not follow its schema."""
    checks = chain(_mistakes(document, RESULT_SCHEMA, ""), _uneven(document), _without_parameters(document))
    for where, what in checks:  # the later ones need the first
        raise InputError(f"{path}: not a contin result, or damaged: {where or 'the document'} {what}")


def first_mistake(document: Record, schema: Record) -> str | None:
    """The first place where a document does not follow a schema, in words; None where it does."""
    for where, what in _mistakes(document, schema, ""):
        return f"{where or 'the document'} {what}"
    return None


def _without_parameters(document: Record) -> Iterator[Mistake]:
    """Manifolds alone have no parameter that varies; their rows say which orbit they are of."""
    for k, branch in enumerate(document["branches"]):
        if branch["kind"] == "manifold":
            if "orbit" not in branch["columns"]:
                yield f"branches[{k}].columns", "of a manifold should have 'orbit'"
        elif not branch["parameters"]:
            yield f"branches[{k}].parameters", "should have 1 to 3 entries"


def _mistakes(value: Json, schema: Record, where: str) -> Iterator[Mistake]:
    allowed = _allowed(schema)
    if allowed is not None and type(value) not in allowed:
        yield where, f"should be {_named(schema['type'])}, is {_shown(value)}"
        return
    if "const" in schema and value != schema["const"]:
        yield where, f"should be {schema['const']!r}, is {_shown(value)}"
    if "enum" in schema and value not in schema["enum"]:
        yield where, f"should be one of {', '.join(map(str, schema['enum']))}, is {_shown(value)}"
    if type(value) is int and not -LARGEST < value < LARGEST:
        yield where, "is an integer beyond all bounds"
    if "minimum" in schema and not value >= schema["minimum"]:
        yield where, f"should be {schema['minimum']} or more, is {_shown(value)}"
    if "pattern" in schema and not re.search(schema["pattern"], value):
        yield where, f"should look like {schema['pattern']}, is {_shown(value)}"
    if type(value) is dict:
        yield from _in_mapping(value, schema, where)
    elif type(value) is list:
        yield from _in_list(value, schema, where)


def _in_mapping(value: Record, schema: Record, where: str) -> Iterator[Mistake]:
    for key in schema.get("required", ()):
        if key not in value:
            yield where, f"has no {key!r}"
    if "oneOf" in schema and sum(all(k in value for k in s["required"]) for s in schema["oneOf"]) != 1:
        yield where, f"should have one of {', '.join(k for s in schema['oneOf'] for k in s['required'])}"
    known = schema.get("properties", {})
    for key, entry in value.items():
        inner = known.get(key, schema.get("additionalProperties"))
        if inner is not None:
            yield from _mistakes(entry, inner, f"{where}.{key}".lstrip("."))


def _in_list(value: list[Json], schema: Record, where: str) -> Iterator[Mistake]:
    if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
        yield where, f"should have {schema.get('minItems', 0)} to {schema.get('maxItems', 'many')} entries"
    inner = schema.get("items")
    if inner is None:
        return
    allowed = _allowed(inner)
    if allowed is not None and not allowed & {dict, list, str}:  # a long column of numbers: types at once
        kinds = set(map(type, value))
        if kinds <= allowed and (int not in kinds or max(map(abs, filter(_is_int, value))) < LARGEST):
            return
    for position, entry in enumerate(value):
        yield from _mistakes(entry, inner, f"{where}[{position}]")


def _is_int(value: object) -> bool:
    return type(value) is int


def _uneven(document: Record) -> Iterator[Mistake]:
    """What a schema cannot say: columns of one length, points on rows."""
    for position, branch in enumerate(document["branches"]):
        where = f"branches[{position}]"
        lengths = {len(column) for column in branch["columns"].values()}
        if len(lengths) > 1:
            yield f"{where}.columns", "have different lengths"
        rows = max(lengths, default=0)
        for number, point in enumerate(branch["points"]):
            if point["index"] >= rows:
                yield f"{where}.points[{number}].index", f"is {point['index']}, and the branch has {rows} rows"
        yield from _uneven_rows(branch, rows, where)
    tables = [*document.get("simulations", []), *([document["sweep"]] if "sweep" in document else [])]
    for table in tables:
        if len({len(column) for column in table["columns"].values()}) > 1:
            yield "simulations or sweep", "have columns of different lengths"


def _uneven_rows(branch: Record, rows: int, where: str) -> Iterator[Mistake]:
    """Spectra and orbits that do not fit to the rows of their branch."""
    kept = branch.get("rows", {})
    values = kept.get("eigenvalues")
    if values is not None and (len(values) != rows or len({len(row) for row in values}) > 1):
        yield f"{where}.rows.eigenvalues", f"should be one list of equal length for each of {rows} rows"
    for number, one in enumerate(kept.get("orbits", ())):
        if one["row"] >= rows:
            yield f"{where}.rows.orbits[{number}].row", f"is {one['row']}, and the branch has {rows} rows"
        if len({len(column) for column in one["orbit"].values()}) > 1:
            yield f"{where}.rows.orbits[{number}].orbit", "has columns of different lengths"


def _allowed(schema: Record) -> frozenset[type] | None:
    written = schema.get("type")
    if written is None:
        return None
    return frozenset().union(*(_TYPES[name] for name in ([written] if isinstance(written, str) else written)))


def _named(written: Json) -> str:
    return str(written) if isinstance(written, str) else " or ".join(written)


def _shown(value: object) -> str:
    text = repr(value) if isinstance(value, str | int | float | bool | None) else f"a {type(value).__name__}"
    return text if len(text) <= 40 else f"{text[:37]}..."
