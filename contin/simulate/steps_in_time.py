"""Flows whose formulas step with the time: floor(t), ceil(t/2), mod(t, 24) < 8.

Where the argument is linear in t, the times of the jumps are known. Between two of them the step function is a
constant, so the flow is integrated from jump to jump with that constant as a parameter: no error estimate ever sees a
jump, and comparisons of mod(t, T) are switching surfaces like others. Step functions of states stay as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.lowering.system import CompiledSystem, compile_in_time
from contin.model.evaluate import evaluate
from contin.model.expression import Expression, add, depends_on, div, mul, neg, number, postorder, substitute, symbol
from contin.model.parts import TIME, Parameter
from contin.records import Fields
from contin.simulate.flight import DONE, Flight, fly
from contin.symbolic.calculus.derivatives import derivative

if TYPE_CHECKING:
    from contin.model.model import Model

WHOLE: Final = "step {}"  # no name in a model contains a blank
MOST_JUMPS: Final = 100_000
SAME: Final = 1e-13  # relative: jumps that are one


@dataclass(frozen=True, eq=False)
class Stepped:
    """`model` with the whole parts of `arguments`, functions of t, as its last parameters."""

    model: Model
    arguments: tuple[Expression, ...]

    def jumps(self, values: Mapping[str, float], duration: float) -> Array:
        """Times in (0, duration) at which an argument passes a whole number, increasing, and the two ends."""
        found = [np.array([0.0, duration])]
        for argument in self.arguments:
            slope = float(evaluate(derivative(argument, TIME), values))
            first = float(evaluate(argument, {**values, TIME: 0.0}))
            last = first + slope * duration
            low, high = np.ceil(min(first, last)), np.floor(max(first, last))
            if not high - low < MOST_JUMPS:
                raise InputError(f"a step function of the time jumps more than {MOST_JUMPS} times in t = {duration:g}")
            if slope != 0.0:
                found.append((np.arange(low, high + 1.0) - first) / slope)
        times = np.unique(np.clip(np.concatenate(found), 0.0, duration))
        kept = np.append(True, np.diff(times) > SAME * duration)
        kept[-1] = True
        times = times[kept]
        return np.append(times[:-1][duration - times[:-1] > SAME * duration], duration)

    def wholes(self, values: Mapping[str, float], t: float) -> Array:
        """The whole parts at the time t."""
        return np.floor([float(evaluate(u, {**values, TIME: t})) for u in self.arguments])


def stepped_in_time(model: Model) -> Stepped | None:
    """The model with the step functions of t taken out; None where there are none."""
    arguments: list[Expression] = []
    replaced: dict[Expression, Expression] = {}
    for node in postorder(model.equations):
        if node.op not in ("floor", "ceil", "mod"):
            continue
        args = substitute(node.args, replaced)
        u = div(*args) if node.op == "mod" else args[0]
        moving = depends_on(u, [TIME]) and not depends_on(u, model.state_names)
        if not moving or depends_on(derivative(u, TIME), [TIME]):
            continue
        if u not in arguments:
            arguments.append(u)
        whole = symbol(WHOLE.format(arguments.index(u)))
        replaced[node] = {"floor": whole, "ceil": add(whole, number(1)), "mod": whole}[node.op]
        if node.op == "mod":
            replaced[node] = add(args[0], neg(mul(args[1], whole)))
    if not arguments:
        return None
    extra = tuple(Parameter(WHOLE.format(k), number(0)) for k in range(len(arguments)))
    equations = tuple(substitute(model.equations, replaced))
    smooth = model.replace(
        equations=equations, parameters=(*model.parameters, *extra), observables={}, symmetries=(), rotation={},
        starts=(), averaging=None, limits=(), expect=(), labels={},
    )  # fmt: skip
    return Stepped(smooth, tuple(arguments))


def fly_between_jumps(
    stepped: Stepped, u: Array, p: Array, times: Array, budget: int, **options: Fields
) -> Flight:
    """The flight from 0 to the last of `times`, from jump to jump; `options` as of `fly`."""
    system: CompiledSystem = compile_in_time(stepped.model)
    values = dict(zip(system.parameter_names, p.tolist(), strict=False))
    jumps = stepped.jumps(values, float(times[-1]))
    kept: list[Flight] = []
    y, done = u, 0
    for begin, end in pairwise(jumps.tolist()):
        upto = int(np.searchsorted(times, end, side="right")) if end < jumps[-1] else times.size
        full = np.append(p, stepped.wholes(values, 0.5 * (begin + end)))
        flight = fly(system, y, full, end - begin, start=begin, times=times[done:upto], budget=budget, **options)  # type: ignore[arg-type]
        kept.append(flight)
        y, done, budget = flight.end, upto, max(budget - flight.steps, 1)
        if flight.outcome != DONE:
            break
    return replace(
        kept[-1], t=np.concatenate([f.t for f in kept]), samples=np.vstack([f.samples for f in kept]),
        crossings=np.vstack([f.crossings for f in kept]), crossed=sum(f.crossed for f in kept),
        steps=sum(f.steps for f in kept), touched=sum(f.touched for f in kept),
    )  # fmt: skip
