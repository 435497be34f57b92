"""Iterates of maps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import symbol
from contin.simulate.condition import condition
from contin.simulate.flight import DONE
from contin.simulate.path import EVENT, NO_EVENT
from contin.simulate.run import Simulation, observed
from contin.systems.steps import AT_ONCE, iterates

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem
    from contin.model.model import Model

LONGEST: Final = 10_000_000


def iterated(
    model: Model, system: CompiledSystem, u: Array, p: Array, time: float, transient: float, box: float,
    until: str | None
) -> Simulation:  # fmt: skip
    """Every iterate after the transient, up to the first one (but the start) for which `until` is true."""
    count, skipped = round(time), round(transient)
    if count + skipped > LONGEST:
        raise InputError(f"a map is iterated at most {LONGEST} times; got {count + skipped}")
    test = None if until is None else _test(model, until)
    outcome, why = DONE, ""
    full = np.append(p, 0.0) if system.is_forced else p
    kept = [np.asarray(u, dtype=float)[None]]
    done, last = 0, count + skipped
    while done < last and outcome == DONE:
        some = iterates(system, kept[-1][-1], full, min(AT_ONCE, last - done), box)[1:]
        if not np.all(np.abs(some[-1]) <= box):
            outcome, why = "escaped", f"left the box at iterate {done + len(some)}: a state exceeds {box:.6g}"
            some = some[:-1]
        met = None if test is None else next((k for k, x in enumerate(some) if test(x, p)), None)
        if met is not None:
            some, outcome, why = some[: met + 1], EVENT, str(until)
        kept.append(some)
        done += len(some)
    if test is not None and outcome == DONE:
        outcome, why = NO_EVENT, f"the event {until} did not come in {count + skipped} iterates"
    states = np.concatenate(kept)[skipped:]
    t = np.arange(skipped, skipped + len(states), dtype=float)
    return Simulation(model, "map", p, t, states, observed(system, states, p, t), float(done), done, 0, outcome, why)


def _test(model: Model, until: str) -> Any:
    """u, p -> whether the condition holds."""
    names = (*model.state_names, *model.parameter_names)
    known = {**model.observables, **model.definitions, **{n: symbol(n) for n in names}}
    holds = condition(until, known, model.functions, "until")

    def test(u: Array, p: Array) -> bool:
        return bool(evaluate(holds, dict(zip(names, [*u.tolist(), *p.tolist()], strict=True))))

    return test
