"""Conditions on solutions that are followed: `period = 5`, `x.max = 2`, `integral(x^2) = 1`, `x + y = p`.

On orbits a formula is made of numbers: `period`, parameters, and functionals of states: integral(...) over one period
in model time, mean(...), norm(...), max(...), min(...), x(start) of forced flows. `x.max`, `x.min`, `x.amplitude` (half
the difference) and `x.norm` are short for these, as are `amplitude` (of the first state) and `norm` (of all states,
sqrt(mean(x^2 + y^2 + ...))), unless the model uses the name itself. On equilibria states stand for themselves.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import Expression, is_condition, sub, symbol, symbols_in
from contin.model.functionals import FunctionalReader
from contin.model.inline import Formulas
from contin.model.parts import TIME, Functional
from contin.model.printing import to_text
from contin.model.source import CallSource, Path, Problems

if TYPE_CHECKING:
    from contin.model.model import Model

PERIOD: Final = "period"
PARTS: Final[Mapping[str, str]] = {
    "max": "max({0})", "min": "min({0})", "amplitude": "((max({0}) - min({0}))/2)", "norm": "norm({0})",
    "mean": "mean({0})", "start": "{0}(start)",
}  # fmt: skip

DOTTED: Final = re.compile(r"(?<![\w.])([^\W\d]\w*)\s*\.\s*([^\W\d]\w*)(?!\w*\s*\()")  # NAME.WORD, not np.sin(


@dataclass(frozen=True)
class Relation:
    """A residual that vanishes, in states and parameters, or in functionals of an orbit, its period and parameters."""

    text: str
    residual: Expression
    functionals: Mapping[str, Functional] = field(default_factory=dict)


def relations_on_orbits(
    model: Model, texts: Sequence[str], problems: Problems, path: Path = ()
) -> tuple[Relation, ...]:
    """Conditions on the orbits of a model; what is wrong with them is noted at its place."""
    formulas = Formulas(problems, [*model.state_names, *model.parameter_names], {})
    formulas.functions, formulas.definitions = dict(model.functions), dict(model.definitions)
    formulas.conditions = {n for n, e in model.definitions.items() if is_condition(e)}
    formulas.names[PERIOD] = symbol(PERIOD)
    reader = FunctionalReader(formulas, model.state_names, TIME, problems)
    found = []
    for k, text in enumerate(texts):
        left, sign, right = _sides(text, problems, (*path, k))
        if not sign:
            continue
        sides = [_written_out(side, model) for side in (left, right)]
        unknown = next((match for side in sides if (match := DOTTED.search(side))), None)
        if unknown is not None:
            problems.add((*path, k), _no_such_part(model, unknown[1], unknown[2]))
            continue
        residual = sub(*(reader.number(side, (*path, k)) for side in sides))
        used = {name: reader.found[name] for name in symbols_in([residual]) if name in reader.found}
        ends = [f for f in used.values() if f.kind in ("start", "end")]
        if ends and model.forcing is None:
            problems.add((*path, k), "an orbit of an autonomous flow may begin anywhere: it has no value at its start")
        if not symbols_in([residual]):
            problems.add((*path, k), "a condition contains `period`, a number such as max(x), mean(x^2), or parameters")
        found.append(Relation(" ".join(text.split()), residual, used))
    return tuple(found)


def relations_on_states(model: Model, texts: Sequence[str], problems: Problems) -> tuple[Relation, ...]:
    """Conditions on equilibria: formulas in states, observables and parameters."""
    found = []
    for k, text in enumerate(texts):
        left, sign, right = _sides(text, problems, (k,))
        if not sign:
            continue
        try:
            residual = sub(model.expression(left), model.expression(right))
        except InputError as error:
            problems.add((k,), str(error))
            continue
        found.append(Relation(" ".join(text.split()), residual))
    return tuple(found)


def relations(model: Model, texts: Sequence[str], on_orbits: bool) -> tuple[Relation, ...]:
    """The same in a call; raises InputError."""
    problems = Problems(CallSource("conditions"))
    read = relations_on_orbits if on_orbits else relations_on_states
    found = read(model, texts, problems)
    if not on_orbits:
        _only_of_orbits(model, texts, problems)
    problems.raise_if_any()
    return found


def _only_of_orbits(model: Model, texts: Sequence[str], problems: Problems) -> None:
    """A condition that orbits have and states at rest have not is said to be one."""
    for text in texts:
        alone, on_orbit = Problems(CallSource("")), Problems(CallSource(""))
        relations_on_states(model, [text], alone)
        relations_on_orbits(model, [text], on_orbit)
        if alone and not on_orbit:
            raise InputError(
                f"the condition {text!r} is one of periodic orbits, but the start is at rest: there it is an equation "
                f"in the states ({', '.join(model.state_names[:6])}) and parameters, such as {model.state_names[0]} = 1"
            )


def measure(model: Model, text: str) -> Relation:
    """A number of an orbit as a column: a relation whose residual is it; raises InputError."""
    if "=" in text:
        raise InputError(f"a column is a formula such as mean(x^2) or max(x) - min(x), not an equation; got {text!r}")
    problems = Problems(CallSource(""))
    read = relations_on_orbits(model, [f"{text} = 0"], problems)
    try:
        problems.raise_if_any()
    except InputError as error:
        raise InputError(str(error).splitlines()[0].removeprefix(": ").removeprefix("[0]: ")) from None
    (found,) = read
    if not found.functionals and PERIOD not in symbols_in([found.residual]):
        raise InputError(f"a column of orbits has a functional such as mean(x^2), max(x), or `period`; got {text!r}")
    return found


def _sides(text: str, problems: Problems, path: Path) -> tuple[str, str, str]:
    left, sign, right = text.partition("=")
    if not sign or right.startswith("=") or "=" in right or left.endswith(("<", ">", "!")):
        problems.add(path, "a condition is an equation with one `=`, such as period = 5")
        return left, "", right
    return left, sign, right


def _no_such_part(model: Model, name: str, part: str) -> str:
    """What may stand where NAME.PART does."""
    known = [*model.state_names, *(n for n in model.observables if n not in model.state_names)]
    if name not in known:
        return f"{name}.{part}: {name} is no state or observable; they are {', '.join(known[:8])}"
    near = closest(part, PARTS) or f"there are {', '.join(f'{name}.{each}' for each in PARTS)}"
    return f"{name} has no {part!r} on an orbit: {near}"


def _written_out(text: str, model: Model) -> str:
    """x.max as max(x), amplitude and norm of all states as the functionals that they are."""
    own = {*model.state_names, *model.parameter_names, *model.definitions}
    things = {name: name for name in model.state_names}
    things |= {name: f"({to_text(e)})" for name, e in model.observables.items() if name not in own}
    names = "|".join(sorted(map(re.escape, things), key=len, reverse=True))

    def functional(match: re.Match[str]) -> str:
        return PARTS[match[2]].format(things[match[1]])

    text = re.sub(rf"(?<![\w.])({names})\s*\.\s*({'|'.join(PARTS)})\b", functional, text)
    squares = " + ".join(f"{name}^2" for name in model.state_names)
    if "amplitude" not in own:
        text = re.sub(r"(?<![\w.])amplitude\b(?!\s*\()", PARTS["amplitude"].format(model.state_names[0]), text)
    if "frequency" not in own:
        text = re.sub(r"(?<![\w.])frequency\b(?!\s*\()", "(1/period)", text)
    if "norm" not in own:
        text = re.sub(r"(?<![\w.])norm\b(?!\s*\()", f"sqrt(mean({squares}))", text)
    return text
