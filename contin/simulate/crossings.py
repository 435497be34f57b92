"""Poincare sections of simulated trajectories: the states at which an expression crosses zero, located as events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

from contin.errors import InputError
from contin.model.expression import Expression, depends_on, postorder, sub
from contin.model.kinds import JUMPING
from contin.model.parts import TIME, Event
from contin.simulate.resets import SENSES, Jump

if TYPE_CHECKING:
    from contin.model.model import Model

KEYS: Final = ("when", "direction")


def section_of(model: Model, section: str | Mapping[str, object]) -> Event:
    """An event without a jump on the section: 'x - 1', 'x = 1', or {when: .., direction: up | down | both}.

    Crossings upwards are taken unless it says otherwise. Raises InputError.
    """
    given = {"when": section} if isinstance(section, str) else dict(section)
    unknown = sorted(set(given) - set(KEYS))
    if unknown or not isinstance(given.get("when"), str):
        raise InputError("section: expected an expression such as 'x - 1', or {when: x - 1, direction: up}")
    direction = given.get("direction", "up")
    if not isinstance(direction, str) or direction not in SENSES:
        raise InputError(f"section: direction must be up, down or both; got {direction!r}")
    if model.kind != "flow" or model.mass:
        what = "with a mass matrix" if model.mass else f"of kind: {model.kind}"
        raise InputError(f"section: sections belong to flows; model {model.name!r} is one {what}")
    when = _difference(model, str(given["when"]))
    moving = [*model.state_names, TIME]
    if not depends_on(when, moving):
        raise InputError("section: no state and no t occurs in it, so it is never crossed; write e.g. x - 1")
    if any(n.op in JUMPING and depends_on(n, moving) for n in postorder([when])):
        raise InputError("section: floor, ceil and mod jump over zero; at times n*T write sin(2*pi*t/T)")
    return Event(when, direction, {})


def _difference(model: Model, text: str) -> Expression:
    """`a = b` is the section a - b."""
    left, equals, right = text.partition("=")
    if not equals:
        return model.expression(text)
    if "=" in right or left.endswith(("<", ">", "!")):
        raise InputError(f"section: {text!r} is a condition; write an expression that is zero on it: x - 1, or x = 1")
    return sub(model.expression(left), model.expression(right))


def separated(jumps: Sequence[Jump], count: int) -> tuple[tuple[Jump, ...], tuple[Jump, ...]]:
    """(jumps of the model's own `count` events, crossings of the section, which is one more).

    A jump that carries the state over the section does not cross it.
    """
    own, crossings = [], []
    for k, jump in enumerate(jumps):
        mine = tuple(e for e in jump.events if e < count)
        carried = k > 0 and jumps[k - 1].time == jump.time
        if mine:
            own.append(Jump(jump.time, mine, jump.before, jump.after))
        if len(mine) < len(jump.events) and not carried:
            crossings.append(jump)
    return tuple(own), tuple(crossings)
