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
    kept, outcome, why = [u], DONE, ""
    full = np.append(p, 0.0) if system.is_forced else p
    for k in range(count + skipped):
        u = system.value(u, full)
        if not np.all(np.abs(u) <= box):
            outcome, why = "escaped", f"left the box at iterate {k + 1}: a state exceeds {box:.6g}"
            break
        kept.append(u)
        if test is not None and test(u, p):
            outcome, why = EVENT, str(until)
            break
    else:
        if test is not None:
            outcome, why = NO_EVENT, f"the event {until} did not come in {count + skipped} iterates"
    states = np.array(kept[skipped:]).reshape(-1, system.n)
    t = np.arange(skipped, skipped + len(states), dtype=float)
    end = float(len(kept) - 1)
    return Simulation(model, "map", p, t, states, observed(system, states, p, t), end, len(kept) - 1, 0, outcome, why)


def _test(model: Model, until: str) -> Any:
    """u, p -> whether the condition holds."""
    names = (*model.state_names, *model.parameter_names)
    known = {**model.observables, **model.definitions, **{n: symbol(n) for n in names}}
    holds = condition(until, known, model.functions, "until")

    def test(u: Array, p: Array) -> bool:
        return bool(evaluate(holds, dict(zip(names, [*u.tolist(), *p.tolist()], strict=True))))

    return test
