"""Values of parameters that may be given by formulas in other parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Union

from contin.errors import ExpressionError, InputError, NotFiniteError
from contin.limits import brief
from contin.model.advice import closest
from contin.model.evaluate import evaluate
from contin.model.explain import explain_not_finite
from contin.model.expression import Expression, as_expression, symbols_in
from contin.model.order import CircleError, dependency_order
from contin.model.parser import parse
from contin.model.parts import Parameter
from contin.model.scope import Function

Override = Union[str, int, float, Fraction, Expression]


def parameter_values(
    parameters: Sequence[Parameter],
    layers: Sequence[Mapping[str, Override]],
    functions: Mapping[str, Function] | None = None,
) -> dict[str, float]:
    """Values in the order of `parameters`; each of `layers` overrides the defaults and the layers before it."""
    names = [p.name for p in parameters]
    if layers and set(map(type, layers[-1].values())) == {float} and layers[-1].keys() == set(names):
        given = {name: float(layers[-1][name]) for name in names}  # type: ignore[arg-type]
        if all(map(math.isfinite, given.values())):
            return given
    formulas = {p.name: p.value for p in parameters}
    for layer in layers:
        for name, value in layer.items():
            if name not in formulas:
                advice = closest(name, names) or f"there are {', '.join(names) or 'none'}"
                raise InputError(f"no parameter {name!r}: {advice}")
            formulas[name] = _formula(name, value, names, functions or {})
    try:
        order = dependency_order({name: symbols_in([formula]) for name, formula in formulas.items()})
    except CircleError as error:
        raise InputError(f"parameters are defined in a circle: {error}") from None
    values: dict[str, float] = {}
    for name in order:
        value = float(evaluate(formulas[name], values))
        if not math.isfinite(value):
            reason = explain_not_finite({name: formulas[name]}, values, "parameter")
            raise NotFiniteError(reason)
        values[name] = value
    return {name: values[name] for name in names}


def _formula(name: str, value: Override, names: list[str], functions: Mapping[str, Function]) -> Expression:
    if isinstance(value, str):
        try:
            return parse(value, names, functions)
        except ExpressionError as error:
            raise InputError(f"parameter {name} = {brief(value)}: {error}") from None
    if isinstance(value, bool):
        raise InputError(f"parameter {name}: expected a number or a formula, got {value}")
    formula = value if isinstance(value, Expression) else as_expression(_plain(value, name))
    unknown = [s for s in symbols_in([formula]) if s not in names]
    if unknown:
        raise InputError(f"parameter {name}: {unknown[0]!r} is not a parameter")
    return formula


def _plain(value: object, name: str) -> int | float | Fraction:
    if isinstance(value, (int, Fraction)):
        return value
    try:
        number = float(value)  # type: ignore[arg-type]  # numpy scalars too
    except (TypeError, ValueError):
        raise InputError(f"parameter {name}: expected a number or a formula, got {value!r}") from None
    if not math.isfinite(number):
        raise InputError(f"parameter {name}: expected a finite number, got {number}")
    return number
