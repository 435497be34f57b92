"""Time and the phases of rotators in equations, as phasors: cos(2 Omega t + delta) becomes a polynomial in cos and sin.

A phase may stand under sin and cos only, as an integer multiple; sums and differences of phases are multiplied out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import (
    ONE,
    ZERO,
    Expression,
    add,
    call,
    mask_of,
    mul,
    number,
    postorder,
    power,
    rebuild,
    sub,
    substitute,
    symbol,
)
from contin.model.printing import to_text
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, expand, times, to_power
from contin.symbolic.averaging.reading import is_zero
from contin.symbolic.calculus.derivatives import derivative

MOST: Final = 12  # the highest harmonic of a phase that is multiplied out


@dataclass(frozen=True)
class Phase:
    """A name (`t`, or a rotator's state) that advances at `rate` = 1 (a phase itself) or Omega (time).

    symbols : those of cos and -speed sin of the phase.
    """

    name: str
    rate: Expression
    symbols: tuple[str, str]
    speed: Expression

    @property
    def turn(self) -> Complex:
        """cos + i sin"""
        cos, velocity = self.symbols
        return symbol(cos), mul(number(-1), symbol(velocity), power(self.speed, number(-1)))


def with_phasors(
    equations: Mapping[str, Expression],
    phases: Sequence[Phase],
    values: Mapping[str, float],
    name: str,
    where: str = "",
) -> dict[str, Expression]:
    """The equations with every sin and cos of the phases written in their symbols.

    Raises
    ------
    InputError
        A phase stands elsewhere than under sin and cos, or not as an integer multiple; quoted.
    """
    mask = mask_of(phase.name for phase in phases)
    done: dict[Expression, Expression] = {}
    for node in postorder(list(equations.values())):
        if node.op in ("sin", "cos") and node.mask & mask:
            re, im = _unit(node.args[0], phases, values, name)
            done[node] = re if node.op == "cos" else im
        else:
            args = tuple(done[a] for a in node.args)
            done[node] = rebuild(node, args) if args else node
    result = {state: done[right] for state, right in equations.items()}
    for state, right in result.items():
        if right.mask & mask:
            left = next(p.name for p in phases if right.mask & mask_of([p.name]))
            place = where or f"the equation of {state}"
            raise InputError(
                f"averaging model {name}: in {place}, {left} stands elsewhere than under sin and cos; "
                "write the equation with sin and cos of whole multiples of the phase, such as cos(2*Omega*t + delta)"
            )
    return result


def _unit(angle: Expression, phases: Sequence[Phase], values: Mapping[str, float], name: str) -> Complex:
    """exp(i angle) = exp(i delta) prod z_p^k_p."""
    rest = substitute([angle], {symbol(p.name): ZERO for p in phases})[0]
    unit: Complex = (ONE, ZERO) if rest is ZERO else (call("cos", rest), call("sin", rest))
    linear = rest
    for phase in phases:
        slope = substitute([derivative(angle, phase.name)], {symbol(p.name): ZERO for p in phases})[0]
        if slope is ZERO:
            continue
        ratio = float(evaluate(slope, values)) / float(evaluate(phase.rate, values))
        whole = round(ratio) if math.isfinite(ratio) else 0
        if abs(whole) > MOST or not is_zero(sub(slope, mul(number(whole), phase.rate))):
            raise InputError(
                f"averaging model {name}: {to_text(angle)} turns {ratio:.6g} times with {phase.name}"
                f"{'' if phase.rate is ONE else ' in one period of the forcing'}; whole multiples up to {MOST} are "
                "averaged. If two frequencies are close, write their difference as a detuning of the oscillator"
            )
        linear = add(linear, mul(slope, symbol(phase.name)))
        turn = to_power(phase.turn if whole > 0 else conjugate(phase.turn), abs(whole))
        unit = expand(times(unit, turn))
    if not is_zero(sub(angle, linear)):
        raise InputError(f"averaging model {name}: {to_text(angle)} is not linear in the phases")
    return unit
