"""A model as text: the model file that loads to an equal model, and a summary for people."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

from contin.model.expression import Expression
from contin.model.latex import latex_name, to_latex
from contin.model.printing import to_text
from contin.model.schema import FORMAT_VERSION
from contin.model.totals import total_lines

if TYPE_CHECKING:
    from contin.model.model_parts import ModelParts

_PLAIN = re.compile(r"[^\W\d_][\w .,;()/^*+=<>!-]*|-[\w.(][\w .,;()/^*+=<>!-]*|[(0-9.][\w .,;()/^*+=<>!-]*")
_WORDS = frozenset({"null", "true", "false", "~"})  # plain scalars that YAML would not read as texts


def definition_names(definitions: Mapping[str, Expression]) -> dict[Expression, str]:
    """Nodes that stand for a definition, so that a formula can be written as its author did."""
    return {node: name for name, node in definitions.items() if node.args}


def model_text(model: ModelParts) -> str:
    """The model file (YAML). Formulas use the definitions' names wherever the same part occurs."""
    return "\n".join(_lines(model)) + "\n"


def _lines(model: ModelParts) -> Iterator[str]:
    names = definition_names(model.definitions)

    def formula(node: Expression) -> str:
        return _scalar(to_text(node, names))

    yield f"contin: {FORMAT_VERSION}"
    for key in ("name", "title", "source", "description"):
        value = getattr(model, key)
        if value is not None:
            yield f"{key}: {_text(value)}"
    if model.kind != "flow":
        yield f"kind: {model.kind}"
    if model.interval is not None:
        ends = {"from": formula(model.interval.start), "to": formula(model.interval.end)}
        yield f"time: {_mapping({'name': model.interval.name, **ends})}"
    yield from _names(model, formula)
    if model.functions:
        yield "functions:"
        for f in model.functions.values():
            yield f"  {f.heading}: {_scalar(f.text)}"
    if model.definitions:
        yield "definitions:"
        for name, node in model.definitions.items():
            others = {n: other for n, other in names.items() if n is not node}
            yield f"  {_key(name)}: {_scalar(to_text(node, others))}"
    yield "equations:" if model.states else "equations: {}"
    for name, node in model.equation_map.items():
        yield f"  {_key(name)}: {formula(node)}"
    if model.mass:
        yield "mass:"
        for name, row in model.mass.items():
            whole = {k: formula(v) for k, v in row.items()} or {name: "0"}
            alone = set(whole) == {name}
            yield f"  {_key(name)}: {whole[name] if alone else _mapping(whole)}"
    if model.conditions:
        yield "conditions:"
        for condition in model.conditions:
            yield f"  - {_scalar(condition.text)}"
    if model.observables:
        yield "observables:"
        for name, node in model.observables.items():
            yield f"  {_key(name)}: {formula(node)}"
    if model.labels:
        yield f"labels: {_mapping({name: _text(label) for name, label in model.labels.items()})}"
    if model.symmetries:
        yield "symmetries:"
        for symmetry in model.symmetries:
            yield f"  {_key(symmetry.name)}: {_mapping({k: formula(v) for k, v in symmetry.map.items()})}"
    if model.rotation:
        yield f"rotation: {_mapping({k: formula(v) for k, v in model.rotation.items()})}"
    yield from _declarations(model, formula)


def _names(model: ModelParts, formula: Callable[[Expression], str]) -> Iterator[str]:
    """States and parameters, with what is declared of each."""
    yield "states:" if model.states else "states: {}"
    for s in model.states:
        more = {} if s.period is None else {"period": formula(s.period)}
        if s.minimum is not None:
            more["minimum"] = formula(s.minimum)
        if s.beyond is not None:
            more["beyond"] = _text(s.beyond)
        if s.scale is not None:
            more["scale"] = formula(s.scale)
        yield f"  {_key(s.name)}: {_entry(formula(s.value), more, s.unit, s.description)}"
    if model.parameters:
        yield "parameters:"
        for p in model.parameters:
            more = {} if p.range is None else {"range": f"[{_flow(formula(p.range[0]))}, {_flow(formula(p.range[1]))}]"}
            if p.scale is not None:
                more["scale"] = formula(p.scale)
            yield f"  {_key(p.name)}: {_entry(formula(p.value), more, p.unit, p.description)}"


def _averaging(model: ModelParts) -> Iterator[str]:
    item = model.averaging
    if item is None:
        return
    yield "averaging:"
    yield f"  small: {_key(item.small)}"
    pairs = [{"position": o.position, "velocity": o.velocity, **_harmonic(o.harmonic)} for o in item.oscillators]
    yield f"  oscillators: [{', '.join(_mapping(pair) for pair in pairs)}]"
    if item.forcing != 1:
        yield f"  forcing: {item.forcing}"
    if item.rotators:
        turning = (_mapping({"phase": r.phase, **_harmonic(r.harmonic)}) for r in item.rotators)
        yield f"  rotators: [{', '.join(turning)}]"
    for key, names in (("slow", item.slow), ("slaved", item.slaved)):
        if names:
            yield f"  {key}: [{', '.join(names)}]"


def _harmonic(number: int) -> dict[str, str]:
    return {} if number == 1 else {"harmonic": str(number)}


def _declarations(model: ModelParts, formula: Callable[[Expression], str]) -> Iterator[str]:
    """What follows the equations and their symmetries: starts, averaging, forcing, limits and expected points."""
    if model.starts:
        yield "starts:"
        for start in model.starts:
            values = {k: formula(v) for k, v in start.states.items()}
            if start.parameters:
                inner = _mapping({k: formula(v) for k, v in start.parameters.items()})
                values["parameters"] = inner
            yield f"  {_key(start.name)}: {_mapping(values)}"
    yield from _averaging(model)
    if model.forcing is not None:
        yield f"forcing: {{period: {_flow(formula(model.forcing.period))}}}"
    if model.limits:
        yield "limits:"
        for limit in model.limits:
            parts = {"margin": _flow(formula(limit.margin)), "beyond": _text(limit.beyond)}
            if limit.accuracy:
                parts["accuracy"] = repr(limit.accuracy)
            yield f"  - {_mapping(parts)}"
    if model.events:
        yield "events:"
        for event in model.events:
            jumps = _mapping({k: formula(v) for k, v in event.jumps.items()})
            yield f"  - {{when: {_flow(formula(event.when))}, direction: {event.direction}, set: {jumps}}}"
    yield from _totals(model, formula)
    if model.expect:
        yield "expect:"
        for item in model.expect:
            points = [_mapping({k: formula(v) for k, v in point.items()}) for point in item.at]
            at = points[0] if len(points) == 1 else f"[{', '.join(points)}]"
            values = {"label": _text(item.label), "at": at, "tolerance": repr(item.tolerance)}
            if item.runs:
                values["run"] = _data(item.runs[0] if len(item.runs) == 1 else list(item.runs))
            if item.transform:
                values["transform"] = _data(list(item.transform))
            yield f"  - {_mapping(values)}"


def _totals(model: ModelParts, formula: Callable[[Expression], str]) -> Iterator[str]:
    """What is known of conserved totals."""
    if not model.conserved:
        yield "conserved: false"
    elif model.totals:
        yield "conserved:"
    for t in model.totals:
        law = _mapping({name: formula(c) for name, c in t.law.items()})
        more = {"state": _key(t.state.name), "value": formula(t.state.value), "law": law}
        for key, text in (("unit", t.state.unit), ("description", t.state.description), ("note", t.note or None)):
            if text is not None:
                more[key] = _text(text)
        yield f"  {_key(t.name)}: {_mapping(more)}"


def _entry(value: str, more: dict[str, str], unit: str | None, description: str | None) -> str:
    if unit is not None:
        more["unit"] = _text(unit)
    if description is not None:
        more["description"] = _text(description)
    return _mapping({"value": value, **more}) if more else value


def _mapping(values: Mapping[str, str]) -> str:
    return "{" + ", ".join(f"{_key(k)}: {_flow(v)}" for k, v in values.items()) + "}"


def _flow(value: str) -> str:
    """A value inside { } or [ ], where a comma ends a plain scalar."""
    if value[:1] in '"{[' or "," not in value:
        return value
    return json.dumps(value, ensure_ascii=False)


def _scalar(formula: str) -> str:
    if formula.lower() in _WORDS or not _PLAIN.fullmatch(formula):
        return json.dumps(formula, ensure_ascii=False)
    return formula


def _text(value: str) -> str:
    plain = re.fullmatch(r"[^\W\d_][\w .()/-]*", value) and not value.endswith((" ", ":")) and "  " not in value
    return value if plain and value.lower() not in _WORDS else json.dumps(value, ensure_ascii=False)


def _key(name: str) -> str:
    return name if re.fullmatch(r"[^\W\d]\w*(-\w+)*", name) else json.dumps(name, ensure_ascii=False)


def _data(value: object) -> str:
    """Plain data of a run: JSON is YAML."""
    return json.dumps(value, ensure_ascii=False)


def model_latex(model: ModelParts) -> str:
    """Equations and definitions in a LaTeX `align*` environment."""
    names = definition_names(model.definitions)
    mark = r"\dot{%s}" if model.kind == "flow" else r"%s \mapsto"
    relation = "=" if model.kind == "flow" else ""
    lines = [
        f"{mark % latex_name(name)} &{relation} {to_latex(node, names)}" for name, node in model.equation_map.items()
    ]
    for name, node in model.definitions.items():
        others = {n: other for n, other in names.items() if n is not node}
        lines.append(f"{latex_name(name)} &= {to_latex(node, others)}")
    return "\\begin{align*}\n  " + " \\\\\n  ".join(lines) + "\n\\end{align*}"


def summary(model: ModelParts) -> str:
    """A few lines for people: equations, parameters, and what else is declared."""
    names = definition_names(model.definitions)
    lines = [f"{model.name}: {model.title}" if model.title else model.name]
    if model.source:
        lines.append(f"  source: {model.source}")
    mark = "'" if model.kind == "flow" else " ->"
    width = max((len(s.name) + len(mark) for s in model.states), default=0)
    sign = "=" if model.kind == "flow" else ""
    for name, node in model.equation_map.items():
        lines.append(f"  {name + mark:<{width}} {sign} {to_text(node, names)}".replace("->  ", "-> "))
    for name, node in model.definitions.items():
        others = {n: other for n, other in names.items() if n is not node}
        lines.append(f"  with {name} = {to_text(node, others)}")
    if model.parameters:
        listed = ", ".join(
            f"{p.name} = {to_text(p.value)}" + (f" {p.unit}" if p.unit else "") for p in model.parameters
        )
        lines.append(f"  parameters: {listed}")
    angles = [f"{s.name} (period {to_text(s.period)})" for s in model.states if s.period is not None]
    if angles:
        lines.append(f"  angles: {', '.join(angles)}")
    if model.forcing is not None:
        lines.append(f"  forced with period {to_text(model.forcing.period)} in t")
    for event in model.events:
        way = {"up": "upwards", "down": "downwards"}.get(event.direction, "either way")
        jumps = ", ".join(f"{k} -> {to_text(v, names)}" for k, v in event.jumps.items())
        lines.append(f"  event: where {to_text(event.when, names)} crosses zero {way}, {jumps}")
    lines += [f"  conserved: {line}" for line in total_lines(model.totals)]
    for title, found in (
        ("observables", list(model.observables)),
        ("symmetries", [s.name for s in model.symmetries]),
        ("starts", [s.name for s in model.starts]),
    ):
        if found:
            lines.append(f"  {title}: {', '.join(found)}")
    return "\n".join(lines)
