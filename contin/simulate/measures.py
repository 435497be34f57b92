"""The quantities that are measured until they settle: those asked for, or what a model's declarations suggest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from contin.errors import ExpressionError, InputError
from contin.model.expression import Expression, call, symbol
from contin.model.model import Model
from contin.records import Fields
from contin.simulate.natural import sizes_of
from contin.simulate.systems import need_formulas

ASLEEP: Final = 1e-6  # of the natural sizes: a product of two amplitudes for which their phase difference is nothing


def with_measures(model: Any, measures: Mapping[str, str | Any] | None) -> Model:
    """The model with the quantities to measure as its observables.

    By default: for oscillators declared under `averaging` their amplitudes r1, r2, .. and the cosines c12, c13, .. of
    their phase differences from the first; otherwise states (of an angle its cosine and sine) and observables.
    Raises ExpressionError for a formula that is none.
    """
    if not isinstance(model, Model):
        if measures:
            need_formulas(model, "measures", "let its `record` return what is to be measured")
        measured: Model = model.measured()
        return measured
    if measures:
        for name in measures:
            if not name.isidentifier():
                raise InputError(f"a measure needs a name of letters, digits and _; got {name!r}")
        chosen = {name: e if isinstance(e, Expression) else _read(model, name, str(e)) for name, e in measures.items()}
    elif model.averaging is not None:
        chosen = _of_oscillators(model)
    else:
        chosen = _of_states(model) | dict(model.observables)
    return model.replace(observables=chosen)


def _read(model: Model, name: str, formula: str) -> Expression:
    try:
        return model.expression(formula)
    except ExpressionError as reason:
        raise ExpressionError(f"measure {name}: {reason}", reason.position) from None


def _of_states(model: Model) -> Fields:
    chosen: Fields = {}
    for state in model.states:
        if state.period is None:
            chosen[state.name] = symbol(state.name)
        else:  # an angle that goes round never settles
            turn = symbol(state.name) * model.expression("2*pi") / state.period
            chosen |= {f"cos_{state.name}": call("cos", turn), f"sin_{state.name}": call("sin", turn)}
    return chosen


def _of_oscillators(model: Any) -> Fields:
    pairs = [(o.position, o.velocity) for o in model.averaging.oscillators]
    amplitudes = {f"r{k + 1}": model.expression(f"sqrt({x}^2 + {y}^2)") for k, (x, y) in enumerate(pairs)}
    declared, usual = sizes_of(model, tuple(model.default_parameters().values()))
    sizes = dict(zip(model.state_names, np.where(declared > 0.0, declared, usual), strict=True))
    cosines = {}
    x1, y1 = pairs[0]
    for k, (x, y) in enumerate(pairs[1:], 2):
        asleep = ASLEEP * (max(sizes[x1], sizes[y1]) or 1.0) * (max(sizes[x], sizes[y]) or 1.0)
        product = f"sqrt(({x1}^2 + {y1}^2)*({x}^2 + {y}^2)) + {asleep!r}"
        cosines[f"c1{k}"] = model.expression(f"({x1}*{x} + {y1}*{y})/({product})")
    return amplitudes | cosines
