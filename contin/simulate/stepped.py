"""Flows with step functions: floor(t), mod(t, 24) < 8, ceil(x/2).

The whole part of an argument is a constant between two jumps, so the flow is integrated from jump to jump with that
constant as a parameter: no error estimate ever sees a jump, and comparisons of mod(t, T) are switching surfaces like
others. Of an argument that is linear in t the times of the jumps are known; of others a jump is an event, where the
argument leaves [w, w + 1].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import (
    COMPARISONS,
    Expression,
    add,
    compare,
    depends_on,
    div,
    logical,
    mul,
    neg,
    number,
    postorder,
    substitute,
    symbol,
)
from contin.model.kinds import JUMPING, has_steps
from contin.model.parts import TIME, Parameter
from contin.model.printing import to_text
from contin.symbolic.calculus.derivatives import derivative

if TYPE_CHECKING:
    from contin.model.model import Model

BROKEN: Final = COMPARISONS | {"sign", "heaviside"}
WHOLE: Final = "step {}"  # no name in a model contains a blank
MOST_JUMPS: Final = 100_000
SAME: Final = 1e-13  # relative: jumps that are one
ON: Final = 1e-7  # an argument so near a whole number, relative, is on it: it was landed on


@dataclass(frozen=True, eq=False)
class Stepped:
    """`model` with the whole parts of `arguments` as its last parameters; `timed`: linear in t, and of nothing else."""

    model: Model
    arguments: tuple[Expression, ...]
    timed: tuple[bool, ...]

    @property
    def leaves(self) -> Expression | None:
        """The condition that an argument that is not timed has left its interval; None where all are timed."""
        parts = []
        for k, (u, timed) in enumerate(zip(self.arguments, self.timed, strict=True)):
            if not timed:
                whole = symbol(WHOLE.format(k))
                parts += [compare("<", u, whole), compare(">", u, add(whole, number(1)))]
        return logical("or", *parts) if parts else None

    def jumps(self, values: Mapping[str, float], duration: float) -> Array:
        """Times in (0, duration) at which a timed argument passes a whole number, increasing, and the two ends."""
        found = [np.array([0.0, duration])]
        for u, timed in zip(self.arguments, self.timed, strict=True):
            if not timed:
                continue
            slope = float(evaluate(derivative(u, TIME), values))
            first = float(evaluate(u, {**values, TIME: 0.0}))
            last = first + slope * duration
            low, high = np.ceil(min(first, last)), np.floor(max(first, last))
            if not high - low < MOST_JUMPS:
                raise InputError(f"a step function of the time jumps more than {MOST_JUMPS} times in t = {duration:g}")
            if slope != 0.0:
                found.append((np.arange(low, high + 1.0) - first) / slope)
        times = np.unique(np.clip(np.concatenate(found), 0.0, duration))
        times = times[np.append(True, np.diff(times) > SAME * duration)]
        return np.append(times[:-1][duration - times[:-1] > SAME * duration], duration)

    def wholes(self, values: Mapping[str, float], begin: float, end: float, rates: Mapping[str, float]) -> Array:
        """The whole parts just after `begin`, up to the next jump in time at `end`.

        values : of parameters and states at `begin`; rates : of the states. On a whole number the sign of the rate
        decides.
        """
        known = dict(values)
        for k, (u, timed) in enumerate(zip(self.arguments, self.timed, strict=True)):
            at = {**known, TIME: 0.5 * (begin + end) if timed else begin}
            value = float(evaluate(u, at))
            nearest = float(np.round(value))
            if not timed and abs(value - nearest) <= ON * max(1.0, abs(value)):
                slope = sum(float(evaluate(derivative(u, name), at)) * rate for name, rate in rates.items())
                slope += float(evaluate(derivative(u, TIME), at))
                value = nearest - 0.5 if slope < 0.0 else nearest
            known[WHOLE.format(k)] = float(np.floor(value))
        return np.array([known[WHOLE.format(k)] for k in range(len(self.arguments))])


def stepped(model: Model) -> Stepped | None:
    """The model with its step functions taken out; None where there are none."""
    arguments: list[Expression] = []
    timed: list[bool] = []
    replaced: dict[Expression, Expression] = {}
    moving = [*model.state_names, TIME]
    for node in postorder(model.equations) if has_steps(model) else ():
        if node.op not in JUMPING:
            continue
        args = substitute(node.args, replaced)
        u = div(*args) if node.op == "mod" else args[0]
        if not depends_on(u, moving):
            continue
        if any(n.op in BROKEN and depends_on(n, moving) for n in postorder([u])):
            raise InputError(
                f"model {model.name}: {node.op} of what jumps itself ({to_text(node)[:80]}) is not integrated; write "
                "the cases as conditions (u if c else v)"
            )
        if u not in arguments:
            linear = not depends_on(derivative(u, TIME), [TIME])
            others = [*model.state_names, *(WHOLE.format(k) for k in range(len(arguments)))]
            arguments.append(u)
            timed.append(linear and not depends_on(u, others))
        whole = symbol(WHOLE.format(arguments.index(u)))
        values = {"floor": whole, "ceil": add(whole, number(1))}
        replaced[node] = values.get(node.op) or add(args[0], neg(mul(args[1], whole)))
    if not arguments:
        return None
    extra = tuple(Parameter(WHOLE.format(k), number(0)) for k in range(len(arguments)))
    smooth = model.replace(
        equations=tuple(substitute(model.equations, replaced)), parameters=(*model.parameters, *extra), observables={},
        symmetries=(), rotation={}, starts=(), averaging=None, limits=(), expect=(), labels={},
    )  # fmt: skip
    return Stepped(smooth, tuple(arguments), tuple(timed))
