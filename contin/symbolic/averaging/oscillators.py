"""A model read as weakly nonlinear oscillators (`weak.WeakOscillators`).

The pass needs the equations at eps = 0 to be exactly harmonic, and frequencies to differ from whole multiples of one
base frequency by order eps at most; everything else is refused with the term that does not fit. The base frequency is
that of the forcing, or else of the first oscillator, divided by its `harmonic`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import (
    ONE,
    PI,
    ZERO,
    Expression,
    add,
    call,
    depends_on,
    div,
    mask_of,
    mul,
    number,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.model import Model
from contin.model.parts import TIME, Averaging, Event, Limit, Oscillator
from contin.symbolic.averaging.friction import Rubbing, response_limit, rubbing
from contin.symbolic.averaging.kicks import kick_of
from contin.symbolic.averaging.phasors import Phase, with_phasors
from contin.symbolic.averaging.reading import excess, is_equal, root, series, simplest, stiffness
from contin.symbolic.averaging.slaving import Slaved, follow
from contin.symbolic.averaging.weak import Kick, Phasor, Response, SlowState, WeakOscillators
from contin.symbolic.calculus.derivatives import derivative

NEAR: Final = 5.0  # a relative detuning up to this many times eps counts as of order eps


def weak_oscillators(model: Model, order: int = 1) -> WeakOscillators:
    """The oscillators that the model declares under `averaging:`, with their perturbations up to eps^order.

    Raises
    ------
    InputError
        The model declares none, or has other states; a term of order 1 is not harmonic (the message quotes it); the
        frequencies are in another resonance than declared, or in none.
    """
    item = _declared(model)
    return _Reader(model, item, order).read()


@dataclass
class _Reader:
    model: Model
    item: Averaging
    order: int

    def read(self) -> WeakOscillators:
        model, item = self.model, self.item
        self.eps = symbol(item.small)
        self.near: list[Limit] = []
        self.values = model.default_parameters()
        self.exact, self.base = self.base_frequency()
        phasors, phases = self.phases()
        self.equations = dict(model.equation_map)
        if phases:
            self.equations = with_phasors(self.equations, phases, self.values, model.name)
        self.phase_names = phases
        self.turning = (*item.oscillators, *(phasor.pair for phasor in phasors))
        symbols = [name for pair in self.turning for name in (pair.position, pair.velocity)]
        self.mask = mask_of([*model.state_names, *symbols])
        shifts, detuned = self.detunings()
        slow = [self.slow_terms(name) for name in item.slow]
        slow += [self.phase_terms(r.phase, r.harmonic) for r in item.rotators]
        follower, responses = self.slaved()
        position, velocity = [], []
        for pair, shift in zip(item.oscillators, shifts, strict=True):
            position.append(self.series(pair.position, follower))
            velocity.append(self.series(pair.velocity, follower))
            velocity[-1][0] = add(velocity[-1][0], mul(shift, symbol(pair.position)))
        return WeakOscillators(
            model,
            item.small,
            item.oscillators,
            self.base,
            tuple(zip(*position, strict=True)),
            tuple(zip(*velocity, strict=True)),
            tuple(detuned),
            phasors,
            tuple(self.slow_state(name, extra, turns, follower) for name, extra, turns in slow),
            follower.states,
            (*follower.limits, *self.near),
            tuple(self.kick(event, follower) for event in model.events),
            responses,
        )

    def kick(self, event: Event, follower: Slaved) -> Kick:
        name = self.model.name
        lost = [state for state in event.jumps if state in self.item.slaved]
        if lost:
            raise InputError(f"averaging model {name}: an event moves {lost[0]}, which is slaved; it cannot jump")
        formulas = {"when": event.when, **event.jumps}
        if self.phase_names:
            formulas = with_phasors(formulas, self.phase_names, self.values, name, "an event")
        following = {symbol(n): e for n, e in follower.states.items()}
        found = dict(zip(formulas, substitute(list(formulas.values()), following), strict=True))
        return kick_of(event, {state: found[state] for state in event.jumps}, found["when"], self.item.small, name)

    # Frequencies ------------------------------------------------------------------------------------------------------

    def base_frequency(self) -> tuple[Expression, Expression]:
        """The base frequency, and the same at eps = 0."""
        model, item = self.model, self.item
        if model.forcing is None:
            first = item.oscillators[0]
            square = stiffness(model.name, first, model.equation_map, self.eps, mask_of(model.state_names), self.values)
            base = root(square, self.values)
            base = base if first.harmonic == 1 else simplest(div(base, number(first.harmonic)), self.values)
            return base, base
        exact = simplest(div(mul(number(2), PI), mul(number(item.forcing), model.forcing.period)), self.values)
        if not depends_on(exact, [item.small]):
            return exact, exact
        if self.order > 1:
            raise InputError(
                f"averaging model {model.name} to second order: the period of the forcing contains {item.small}; make "
                "the frequency of the forcing a parameter"
            )
        return exact, substitute([exact], {self.eps: ZERO})[0]

    def phases(self) -> tuple[tuple[Phasor, ...], list[Phase]]:
        """The phasors, and what in the equations they stand for."""
        found: list[tuple[str | None, str, int, Expression]] = []
        if self.model.forcing is not None:
            found.append((None, TIME, self.item.forcing, mul(number(self.item.forcing), self.exact)))
        found += [(r.phase, r.phase, r.harmonic, ONE) for r in self.item.rotators]
        phasors, phases = [], []
        for k, (state, name, harmonic, rate) in enumerate(found):
            symbols = (f"@c{k}", f"@d{k}")
            phasors.append(Phasor(Oscillator(*symbols, harmonic), state))
            phases.append(Phase(name, rate, symbols, mul(number(harmonic), self.base)))
        return tuple(phasors), phases

    def detunings(self) -> tuple[list[Expression], list[int]]:
        """((h omega)^2 - own^2)/eps of every oscillator, and which of them are detuned."""
        shifts, detuned = [], []
        for i, pair in enumerate(self.item.oscillators):
            square = stiffness(self.model.name, pair, self.equations, self.eps, self.mask, self.values)
            wanted = power(mul(number(pair.harmonic), self.base), number(2))
            shift: Expression = ZERO
            if not is_equal(square, wanted):
                self.check_resonance(i, square, wanted)
                shift = div(sub(wanted, square), self.eps)
                if self.model.forcing is not None:
                    self.near.append(self.near_resonance(square, wanted))
            if self.exact is not self.base:
                slope = derivative(power(mul(number(pair.harmonic), self.exact), number(2)), self.item.small)
                shift = add(shift, simplest(substitute([slope], {self.eps: ZERO})[0], self.values))
            if shift is not ZERO:
                detuned.append(i)
            shifts.append(shift)
        return shifts, detuned

    def near_resonance(self, square: Expression, wanted: Expression) -> Limit:
        """Where the detuning, which a parameter may sweep, is of order eps."""
        part = mul(number(NEAR), call("abs", self.eps))
        margin = sub(mul(part, add(number(2), part), wanted), call("abs", sub(wanted, square)))
        return Limit(
            margin,
            f"an oscillator's frequency and the forcing's differ by more than {NEAR:g} {self.item.small}, relatively: "
            "averaging holds near the resonance",
        )

    def check_resonance(self, i: int, square: Expression, wanted: Expression) -> None:
        own, near = (math.sqrt(evaluate(s, {**self.values, self.item.small: 0.0})) for s in (square, wanted))
        if abs(own - near) <= NEAR * abs(self.values[self.item.small]) * near:
            return
        small = f"{self.item.small} = {abs(self.values[self.item.small]):g}"
        harmonic = self.item.oscillators[i].harmonic
        if self.model.forcing is not None:
            raise InputError(
                f"averaging: oscillator {i + 1} has the frequency {own:.6g} with the default parameters, and the "
                f"forcing asks for {near:.6g} (its frequency times {harmonic}/{self.item.forcing}); they may differ by "
                f"order {small}. Give the ratio: `forcing: 2` under averaging where the forcing is twice as fast as "
                "the oscillator, `harmonic: 3` at an oscillator that is three times as fast"
            )
        base = float(evaluate(self.base, {**self.values, self.item.small: 0.0}))
        first = self.item.oscillators[0].harmonic * base
        raise InputError(
            f"averaging: oscillators 1 and {i + 1} have the frequencies {first:.6g}, {own:.6g}: ratio "
            f"{own / first:.6g} with the default parameters; only near-identical frequencies are averaged (1:1 "
            f"resonance, difference of order {small}), or those near a ratio that is declared (`harmonic: 2` at the "
            "oscillator that is twice as fast as the others). If the difference is small, write it as "
            f"{self.item.small} times a detuning"
        )

    # What moves beside the oscillators --------------------------------------------------------------------------------

    def slow_terms(self, name: str) -> tuple[str, Expression, int]:
        rest = excess(self.equations[name], self.eps, {}, self.mask)
        if rest:
            raise InputError(
                f"averaging model {self.model.name}: the state {name} under `slow:` must not move at {self.item.small} "
                f"= 0; the term {rest} is left over. If it decays fast, put {name} under `slaved:`"
            )
        return name, ZERO, 0

    def phase_terms(self, name: str, harmonic: int) -> tuple[str, Expression, int]:
        at_zero = substitute([self.equations[name]], {self.eps: ZERO})[0]
        wanted = mul(number(harmonic), self.base)
        if at_zero.mask & self.mask:
            raise InputError(
                f"averaging model {self.model.name}: at {self.item.small} = 0 the phase {name} must turn at a constant "
                "rate"
            )
        if is_equal(at_zero, wanted):
            return name, ZERO, harmonic
        rate, near = (float(evaluate(e, {**self.values, self.item.small: 0.0})) for e in (at_zero, wanted))
        if abs(rate - near) > NEAR * abs(self.values[self.item.small] * near):
            raise InputError(
                f"averaging: the phase {name} turns at the rate {rate:.6g} with the default parameters, not near "
                f"{near:.6g}, {harmonic} times the base frequency: write its `harmonic`"
            )
        return name, div(sub(at_zero, wanted), self.eps), harmonic

    def slow_state(self, name: str, extra: Expression, turns: int, follower: Slaved) -> SlowState:
        rate = self.series(name, follower)
        rate[0] = add(rate[0], extra)
        return SlowState(name, tuple(rate), turns)

    def slaved(self) -> tuple[Slaved, tuple[Response, ...]]:
        if not self.item.slaved:
            return Slaved({}, ()), ()
        if self.order > 1:
            raise InputError(
                f"averaging model {self.model.name} to second order takes no slaved states, and {self.item.slaved[0]} "
                "is one: use `order: 1`, or put what its equations give for it in its place"
            )
        rubbed = self.rubbed()
        replaced = {call("sign", symbol(n)): symbol(r.response.pair.position) for n, r in rubbed.items()}
        replaced |= {symbol(n): r.velocity for n, r in rubbed.items()}
        if rubbed:
            # sign(V) before V, which it contains
            for mapping in ({k: v for k, v in replaced.items() if k.op == "sign"}, replaced):
                self.equations = dict(
                    zip(self.equations, substitute(list(self.equations.values()), mapping), strict=True)
                )
        others = [n for n in self.item.slaved if n not in rubbed and self.is_used(n)]
        responses = tuple(r.response for r in rubbed.values())
        own = {n: r.velocity for n, r in rubbed.items()}
        limits = tuple(response_limit(r) for r in responses)
        if not others:
            return Slaved(own, limits), responses
        values = {**self.values, **slow_values(self.model)}
        turning = (*self.turning, *(r.pair for r in responses))
        found = follow(
            others,
            self.equations,
            turning,
            lambda j: mul(number(turning[j].harmonic), self.base),
            self.item.small,
            values,
        )
        return Slaved({**own, **found.states}, (*limits, *found.limits)), responses

    def rubbed(self) -> dict[str, Rubbing]:
        """The slaved velocities with dry friction."""
        found = {}
        for k, name in enumerate(self.item.slaved):
            symbols = (f"@s{k}", f"@z{k}")
            one = rubbing(name, self.equations[name], self.turning, self.base, self.item.small, symbols)
            if one is not None:
                found[name] = one
        return found

    def is_used(self, name: str) -> bool:
        """False for a coordinate that no equation contains, such as the place of a platform without a spring."""
        formulas = [*self.equations.values(), *(e.when for e in self.model.events)]
        return any(depends_on(formula, [name]) for formula in formulas)

    def series(self, name: str, follower: Slaved) -> list[Expression]:
        equation = self.equations[name]
        if follower.states:
            equation = substitute([equation], {symbol(n): e for n, e in follower.states.items()})[0]
        return series(equation, self.item.small, self.order)


def slow_values(model: Model) -> dict[str, float]:
    """The default values of the states under `slow:` and `rotators:`."""
    if model.averaging is None:
        return {}
    wanted = (*model.averaging.slow, *(r.phase for r in model.averaging.rotators))
    given: Mapping[str, float] = model.default_parameters()
    return {s.name: float(evaluate(s.value, given)) for s in model.states if s.name in wanted}


def _declared(model: Model) -> Averaging:
    if not isinstance(model, Model):
        raise InputError("only a model of formulas can be averaged; this is a Python function: write its equations")
    item = model.averaging
    if item is None:
        raise InputError(
            f"model {model.name} declares no oscillators; to average it, add to its file\n"
            "averaging: {small: eps, oscillators: [{position: x, velocity: y}]}"
        )
    if model.kind != "flow":
        raise InputError(f"model {model.name} is a map; averaging takes flows")
    if model.uses_time and model.forcing is None:
        raise InputError(f"model {model.name} uses the time t without `forcing: {{period: ...}}`; add it")
    used = {name for p in item.oscillators for name in (p.position, p.velocity)}
    used |= {*item.slow, *item.slaved, *(r.phase for r in item.rotators)}
    others = [name for name in model.state_names if name not in used]
    if others:
        raise InputError(
            f"averaging model {model.name}: the state {others[0]} belongs to no oscillator; eliminate it first, "
            "or add the oscillator it belongs to under averaging: oscillators. States that change slowly stand under "
            "`slow:`, linear ones that decay fast under `slaved:`, phases that turn under `rotators:`"
        )
    return item
