"""What every writer needs of a model: its values, and its formulas as statements of a language."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Final

from contin.exchange.imported import UnsupportedError
from contin.exchange.writing.code import Code, postorder
from contin.exchange.writing.language import Language
from contin.model.expression import Expression, div, number, numeric_value, symbols_in

if TYPE_CHECKING:
    from contin.model.model import Model

# parts of a model that change its equations' meaning and that no writer knows are refused by their names
_WRITTEN: Final = frozenset(
    "name states parameters equations kind title source description functions definitions observables starts "
    "conserved labels".split()
)
_SAID: Final = frozenset("symmetries rotation averaging forcing limits expect".split())  # left out with a note
KINDS: Final = {"flow": "differential equations", "map": "maps"}


@dataclass(frozen=True)
class Values:
    """Default values by name."""

    states: Mapping[str, float]
    parameters: Mapping[str, float]


def checked(model: Model, kinds: Iterable[str], target: str, time: bool = True) -> list[str]:
    """What the target cannot hold, a sentence each; UnsupportedError where the equations would mean something else."""
    if model.kind not in kinds:
        known = " and ".join(KINDS[kind] for kind in kinds)
        raise UnsupportedError(f"model {model.name} is of kind {model.kind}: {target} holds {known} here")
    unknown = [f.name for f in fields(model) if f.name not in _WRITTEN | _SAID and getattr(model, f.name)]
    if unknown:
        raise UnsupportedError(f"model {model.name}: {target} cannot hold its {', '.join(unknown)}")
    if not time and "t" in symbols_in(model.equations):
        raise UnsupportedError(f"model {model.name}: its equations contain the time t, which {target} cannot hold")
    left = [name for name in sorted(_SAID) if name != "expect" and getattr(model, name)]
    notes = [f"not written: {', '.join(left)}"] if left else []
    angles = [s.name for s in model.states if s.period is not None]
    if angles:
        notes.append(f"that {', '.join(angles)} {'is an angle' if len(angles) == 1 else 'are angles'} is not written")
    if any(p.value.op != "number" for p in model.parameters):
        notes.append("parameters that are formulas in others are written as their values")
    return notes


def without_mass(model: Model, target: str, algebraic: bool = False) -> tuple[Model, frozenset[str]]:
    """The model with every equation divided by its mass, and the states that have none.

    UnsupportedError where a row of the mass matrix has other entries, or where a state has no mass and the target holds
    no algebraic equations.
    """
    massless: set[str] = set()
    equations = list(model.equations)
    for i, state in enumerate(model.state_names):
        row = model.mass.get(state)
        if row is None:
            continue
        entry = row.get(state, number(0))
        coupled = any(other != state and numeric(node) != 0 for other, node in row.items())
        if coupled or (numeric(entry) == 0 and not algebraic):
            what = "a mass matrix that couples derivatives" if coupled else f"the algebraic state {state}"
            raise UnsupportedError(f"model {model.name}: {target} cannot hold {what}")
        if numeric(entry) == 0:
            massless.add(state)
        else:
            equations[i] = div(equations[i], entry)
    return model.replace(mass={}, equations=tuple(equations)), frozenset(massless)


def numeric(node: Expression) -> float | None:
    """The value of a number; None of a formula."""
    return float(numeric_value(node)) if node.op == "number" else None


def values(model: Model, start: str | None = None) -> Values:
    """Numbers of a start, by default those that the model's states and parameters have."""
    u, p = model.start_point(start)
    return Values(
        dict(zip(model.state_names, (float(v) for v in u), strict=True)),
        dict(zip(model.parameter_names, (float(v) for v in p), strict=True)),
    )


@dataclass(frozen=True)
class Written:
    """Formulas as text: `before` are assignments (name, formula) in their order."""

    before: list[tuple[str, str]]
    equations: list[str]
    observables: dict[str, str]


def written(
    model: Model,
    language: Language,
    symbols: Mapping[str, str],
    name: Callable[[str], str],
    fresh: Callable[[], str] | None,
    observed: bool = True,
) -> Written:
    """Equations and observables; definitions keep their names (as `name` spells them), other shared parts get new
    ones."""
    code = Code(language, symbols, fresh)
    roots = [*model.equations, *(model.observables.values() if observed else ())]
    code.share(roots)
    definitions = {node: key for key, node in model.definitions.items() if node.args and node.op not in _CONDITIONS}
    for node in postorder(roots, ()):
        if node in definitions:
            code.assign(name(definitions[node]), node)
    equations = [code.text(node) for node in model.equations]
    observables = {key: code.text(node) for key, node in (model.observables if observed else {}).items()}
    return Written(code.assigned, equations, observables)


_CONDITIONS: Final[frozenset[str]] = frozenset({"<", "<=", ">", ">=", "==", "!=", "and", "or", "not"})
