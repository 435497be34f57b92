"""The passes that a run file may name under `transform:`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Final

from contin.errors import ContinError
from contin.model.advice import closest
from contin.model.expression import as_expression, number
from contin.model.model import Model
from contin.model.schema import shown
from contin.model.source import Path, Problems
from contin.records import Record

if TYPE_CHECKING:
    from contin.model.model import Model

PASSES: Final[Mapping[str, tuple[str, str]]] = {
    "array": ("contin.symbolic.passes.array", "array"),
    "average": ("contin.symbolic.averaging.average", "average"),
    "coordinates": ("contin.symbolic.passes.coordinates", "change_coordinates"),
    "corotate": ("contin.symbolic.passes.corotating", "corotate"),
    "fix": ("contin.symbolic.passes.fix_parameters", "fix_parameters"),
    "linearise": ("contin.symbolic.passes.linearisation", "linearise"),
    "scale": ("contin.symbolic.passes.scaling", "scale"),
}
"""Name in the file -> module and function; the options written in the file are its keyword arguments."""


def apply_passes(
    model: Model,
    written: Sequence[str | Record],
    problems: Problems,
    values: Record | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> Model:
    """The model after the passes, in order; what is wrong with them is noted in `problems`.

    `values` are the parameters of the run, `ranges` those that it sweeps: passes that look at sizes (which threshold
    comes first, how many nodes a quadrature needs) see these. The model keeps its own ranges.
    """
    if written and not _made_of_formulas(model):
        problems.add(("transform",), f"{model.name} is a Python function; passes need a model made of formulas")
        return model
    if written and isinstance(model, Model) and model.events and not _averages_first(written):
        what = f"{model.name} has `events`; passes other than average and array do not know of jumps"
        problems.add(("transform",), what)
        return model
    if written and values:
        model = _with_values(model, values)
    own = {p.name: p.range for p in model.parameters} if written else {}
    if written and ranges:
        model = _with_ranges(model, ranges)
    for position, item in enumerate(written):
        path: Path = ("transform", position)
        if not isinstance(item, str) and len(item) != 1:
            problems.add(path, "write one pass an entry: - average: {form: polar}")
            return model
        name, options = (item, {}) if isinstance(item, str) else next(iter(item.items()))
        if not isinstance(item, str):
            path = (*path, name)
        if name not in PASSES:
            advice = closest(name, PASSES) or f"there are {', '.join(PASSES)}"
            problems.add(path, f"there is no pass {name!r}: {advice}", key=not isinstance(item, str))
            return model
        function = _function(name)
        if not _options_fit(function, name, options, path, problems):
            return model
        try:
            model = function(model, **(options or {}))
        except ContinError as error:
            problems.add(path, str(error))
            return model
    if own and ranges:
        model = model.replace(parameters=tuple(replace(p, range=own.get(p.name, p.range)) for p in model.parameters))
    return model


def _averages_first(written: Sequence[str | Record]) -> bool:
    """True where the first pass is `average`, which takes events as kicks and leaves none; `array` keeps them."""
    names = [item if isinstance(item, str) else next(iter(item), "") for item in written]
    first = next((name for name in names if name != "array"), "array")
    return first in ("average", "array")


def _with_ranges(model: Model, ranges: Mapping[str, tuple[float, float]]) -> Model:
    """The model with these ranges."""
    pairs = {name: (number(low), number(high)) for name, (low, high) in ranges.items() if low < high}
    return model.replace(parameters=tuple(replace(p, range=pairs.get(p.name, p.range)) for p in model.parameters))


def _with_values(model: Model, values: Record) -> Model:
    """The model with these values as defaults; what is wrong with them is said where the run is planned."""
    known = {name: value for name, value in values.items() if name in model.parameter_names}
    try:
        numbers = model.default_parameters(known)
    except (ContinError, TypeError):
        return model
    changed = (replace(p, value=as_expression(numbers[p.name])) if p.name in known else p for p in model.parameters)
    return model.replace(parameters=tuple(changed))


def _made_of_formulas(model: object) -> bool:
    return isinstance(model, Model)


def _function(name: str) -> Callable[..., Model]:
    module, function = PASSES[name]
    found: Callable[..., Model] = getattr(import_module(module), function)
    return found


def _options_fit(function: Callable[..., object], name: str, options: object, path: Path, problems: Problems) -> bool:
    if options is None:
        return True
    if not isinstance(options, Mapping):
        problems.add(path, f"expected the options of {name} as a mapping, got {shown(options)}")
        return False
    allowed = [p.name for p in list(inspect.signature(function).parameters.values())[1:]]
    unknown = [option for option in options if option not in allowed]
    for option in unknown:
        advice = closest(option, allowed) or f"{name} takes {', '.join(allowed) or 'no options'}"
        problems.add((*path, option), f"unknown option: {advice}", key=True)
    return not unknown
