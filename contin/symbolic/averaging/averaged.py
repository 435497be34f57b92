"""The averaging pass at work: what it derives on the way, and the averaged model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from contin.errors import InputError
from contin.model.expression import Expression, add, mul, symbol
from contin.model.model import Model
from contin.symbolic.averaging.amplitudes import SlowSystem, refuse_names
from contin.symbolic.averaging.averager import slow_system
from contin.symbolic.averaging.build_form import build_form
from contin.symbolic.averaging.carried_symmetries import averaged_symmetries, gauge_symmetries
from contin.symbolic.averaging.carry_over import (
    amplitudes_in,
    averaged_observables,
    averaged_starts,
    averaged_states,
)
from contin.symbolic.averaging.form_names import FORMS
from contin.symbolic.averaging.forms import AveragedForm, check_form
from contin.symbolic.averaging.oscillators import weak_oscillators
from contin.symbolic.averaging.other_forms import form_of_package, in_new_form, names_of_packages
from contin.symbolic.averaging.reach import limits_of
from contin.symbolic.averaging.second_order import second_order_terms
from contin.symbolic.passes.holding import holds

TIMES = ("slow", "fast")


@dataclass(frozen=True)
class Averaged:
    """An averaged model with what it was derived from, for the document."""

    model: Model
    system: SlowSystem
    form: AveragedForm
    order: int
    time: str
    dropped: tuple[str, ...]


def averaged(
    model: Model, form: str = "polar", time: str = "slow", order: int = 1, reach: float | None = None
) -> Averaged:
    """As `contin.symbolic.averaging.average.average`, with the intermediate results."""
    if time not in TIMES:
        raise InputError(f"averaging: time must be slow or fast; got {time!r}")
    if order not in (1, 2) or isinstance(order, bool):
        raise InputError(f"averaging: order must be 1 or 2; got {order!r}")
    if reach is not None and not (isinstance(reach, int | float) and 0.0 < reach < math.inf):
        raise InputError(f"averaging: reach must be a positive number, the largest amplitude; got {reach!r}")
    other = form_of_package(form) if isinstance(form, str) and form not in FORMS else None
    if other is not None:
        plain = averaged(model, other.base, time, order, reach)
        return replace(plain, model=in_new_form(plain.model, form, other))
    oscillators = weak_oscillators(model, order)
    check_form(form, oscillators, names_of_packages())
    system = slow_system(oscillators, None if reach is None else float(reach))
    built = build_form(system, form)
    equations = built.equations
    limits = limits_of(system, amplitudes_in(built, oscillators))
    if order == 2:
        eps = symbol(oscillators.small)
        corrections, more = second_order_terms(oscillators, system, built)
        limits = tuple({limit.margin: limit for limit in (*limits, *more)}.values())
        equations = tuple(add(e, mul(eps, c)) for e, c in zip(equations, corrections.equations, strict=True))
        corrected = {n: add(built.observables[n], mul(eps, corrections.observables[n])) for n in built.rates}
        built = replace(built, equations=equations, observables={**built.observables, **corrected})
    if time == "fast":
        eps = symbol(oscillators.small)
        equations = tuple(mul(eps, e) for e in equations)
    made = [*built.states, *built.observables]
    refuse_names(model.parameter_names, [s.name for s in oscillators.slow], made)
    observables, dropped = averaged_observables(built, oscillators)
    result = Model.from_parts(
        name=model.name,
        title=_title(model, form),
        source=model.source,
        description=_description(model, system, built, order, time, dropped),
        states=averaged_states(built, oscillators),
        parameters=model.parameters,
        equations=equations,
        observables={**built.observables, **observables},
        starts=averaged_starts(built, oscillators),
        definitions=_free(built.definitions, [*model.parameter_names, *built.states, *built.observables]),
        rotation=built.rotation,
        limits=limits,
        symmetries=(),
    )
    candidates = [*averaged_symmetries(built, oscillators), *gauge_symmetries(built, oscillators)]
    result = result.replace(symmetries=tuple(s for s in candidates if holds(result, s)))
    return Averaged(result, system, built, order, time, tuple(dropped))


def _free(definitions: Mapping[str, Expression], taken: Sequence[str]) -> dict[str, Expression]:
    """Definitions only shorten what is printed; those whose name is taken are left out."""
    return {name: node for name, node in definitions.items() if name not in taken}


def _title(model: Model, form: str) -> str:
    return f"{model.title or model.name}, averaged ({form} form)"


def _description(
    model: Model, system: SlowSystem, form: AveragedForm, order: int, time: str, dropped: list[str]
) -> str:
    small = system.oscillators.small
    clock = f"slow time {small} t" if time == "slow" else "time t"
    sentences = [f"Averaged to order {order} in {small}, in the {clock}"]
    if form.valid:
        sentences.append(form.valid[0].upper() + form.valid[1:])
    if system.presumes:
        sentences.append("Closed forms presume " + ", ".join(system.presumes))
    if dropped:
        sentences.append(f"Without {', '.join(dropped)}, which change along an oscillation")
    text = ". ".join(sentences) + "."
    return f"{model.description.rstrip()} {text}" if model.description else text
