"""How an averaged model came about: original equations, transformation, integrals piece by piece, result."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from contin import lazy
from contin.model.expression import ZERO, Expression, add, call, mul, neg, number, substitute, symbol
from contin.model.latex import latex_name
from contin.model.model import Model
from contin.model.parts import TIME
from contin.model.writer import definition_names
from contin.symbolic.averaging.averaged import Averaged, averaged
from contin.symbolic.averaging.cells import RADIUS, Cut
from contin.symbolic.averaging.document import (
    Block,
    Formula,
    Heading,
    Sentence,
    as_latex,
    as_markdown,
    as_text,
    equation_of,
)
from contin.symbolic.averaging.radial import Piece, RadialAverage
from contin.symbolic.averaging.switching_lines import X, Y
from contin.symbolic.averaging.weak import WeakOscillators
from contin.symbolic.calculus.sympy_bridge import from_sympy


@dataclass(frozen=True)
class Derivation:
    """The averaged `model` and the blocks of its derivation."""

    model: Model
    title: str
    blocks: tuple[Block, ...]

    def text(self) -> str:
        """For the terminal."""
        return as_text(self.blocks)

    def markdown(self) -> str:
        """Markdown with LaTeX formulas."""
        return as_markdown(self.blocks)

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook models").derivation_page(self))

    def latex(self) -> str:
        """A LaTeX article."""
        return as_latex(self.blocks, self.title)


def derive(model: Model, form: str = "polar", time: str = "slow", order: int = 1) -> Derivation:
    """`average` with the steps in between, as a document."""
    result = averaged(model, form, time, order)
    blocks = (
        *_original(model),
        *_perturbations(result),
        *_transformation(result),
        *_integrals(result),
        *_products(result),
        *_kicks(result),
        *_friction(result),
        *_result(result),
    )
    title = f"{model.title or model.name}: averaging, {form} form"
    return Derivation(result.model, title, blocks)


def _original(model: Model) -> Iterator[Block]:
    yield Heading("Equations of motion")
    names = definition_names(model.definitions)
    for state, right in model.equation_map.items():
        yield equation_of(state, right, names)
    for name, node in model.definitions.items():
        others = {n: other for n, other in names.items() if n is not node}
        yield Formula(name, latex_name(name), node, others)


def _perturbations(result: Averaged) -> Iterator[Block]:
    oscillators = result.system.oscillators
    small = oscillators.small
    yield Heading("Weakly nonlinear oscillators")
    yield Sentence(
        f"At {small} = 0 every oscillator is harmonic with the frequency omega = {{0}}. "
        if oscillators.is_plain
        else f"At {small} = 0 oscillators are harmonic; the base frequency is omega = {{0}}. ",
        (oscillators.omega,),
    )
    for i, harmonic in enumerate(oscillators.harmonics[: oscillators.count]):
        if harmonic != 1:
            yield Sentence(f"Oscillator {i + 1} has the frequency {harmonic} omega.")
    for i in oscillators.detuned:
        yield Sentence(
            f"The frequency of oscillator {i + 1} differs by order {small}; the difference is part of its F."
        )
    for k, (positions, velocities) in enumerate(zip(oscillators.position, oscillators.velocity, strict=True), start=1):
        power = small if k == 1 else f"{small}^{k}"
        yield Sentence(f"The terms of order {power} are")
        for pair, e, f in zip(oscillators.pairs, positions, velocities, strict=True):
            if not (e.is_number and e.value == 0):
                seen = _with_phases(e, oscillators)
                yield Formula(f"E{k}({pair.position})", rf"E_{{{k}}}({latex_name(pair.position)})", seen)
            seen = _with_phases(f, oscillators)
            yield Formula(f"F{k}({pair.velocity})", rf"F_{{{k}}}({latex_name(pair.velocity)})", seen)
    if oscillators.slaved:
        yield Sentence("Slaved states follow the oscillators:")
    for name, formula in oscillators.slaved.items():
        yield Formula(name, latex_name(name), _with_phases(formula, oscillators))
    if oscillators.slow:
        yield Sentence(f"States that change slowly have the rates, of order {small},")
    for state in oscillators.slow:
        yield Formula(f"G({state.name})", f"G({latex_name(state.name)})", _with_phases(state.rate[0], oscillators))


def _with_phases(formula: Expression, oscillators: WeakOscillators) -> Expression:
    """Phasors as sin and cos of the time, or of a rotator's phase."""
    mapping: dict[Expression, Expression] = {}
    for response in oscillators.responses:
        mapping[symbol(response.pair.position)] = symbol("sign_V")
        mapping[symbol(response.pair.velocity)] = symbol("sign_V_rate")
    for phasor in oscillators.phasors:
        rate = mul(number(phasor.pair.harmonic), oscillators.omega)
        phase = symbol(phasor.state) if phasor.state is not None else mul(rate, symbol(TIME))
        mapping[symbol(phasor.pair.position)] = call("cos", phase)
        mapping[symbol(phasor.pair.velocity)] = mul(neg(rate), call("sin", phase))
    return substitute([formula], mapping)[0] if mapping else formula


def _transformation(result: Averaged) -> Iterator[Block]:
    omega = result.system.omega
    r, phi = symbol("r"), symbol("phi")
    yield Heading("Transformation")
    yield Sentence("With phi = omega t + theta, each oscillator is written as")
    yield Formula("x", "x", mul(r, call("cos", phi)))
    yield Formula("y", "y", mul(number(-1), omega, r, call("sin", phi)))
    yield Sentence("so that, exactly,")
    small = symbol(result.system.oscillators.small)
    e, f = symbol("E"), symbol("F")
    cos, sin = call("cos", phi), call("sin", phi)
    force = mul(f, omega ** number(-1))
    yield equation_of("r", mul(small, add(mul(e, cos), neg(mul(force, sin)))))
    yield Formula("r theta'", r"r \dot{\theta}", mul(small, neg(add(mul(e, sin), mul(force, cos)))))
    yield Sentence(
        "Amplitudes and phases change slowly; their right-hand sides are replaced by their means over one turn of phi."
    )


def _integrals(result: Averaged) -> Iterator[Block]:
    seen: list[Expression] = []
    parts = [part for equation in result.system.equations for part in equation.parts]
    if not parts:
        return
    yield Heading("Means of the forces of one oscillator")
    yield Sentence("S is the mean of f sin(phi), C the mean of f cos(phi), for each force f(x, y):")
    for _, function, average in parts:
        if function in seen:
            continue
        seen.append(function)
        yield Formula("f", "f", _shown(function))
        yield from _pieces(average)


def _pieces(average: RadialAverage) -> Iterator[Block]:
    low: Expression | None = None
    for piece in average.pieces:
        if len(average.pieces) > 1:
            yield Sentence(*_interval(low, piece))
        for arc in piece.arcs:
            if len(piece.arcs) > 1 or len(average.pieces) > 1:
                ends = (_angle(arc.start), _angle(arc.stop))
                yield Sentence("f = {0} for phi from {1} to {2},", (_shown(arc.formula), *ends))
        if piece.nodes:
            yield Sentence(f"no closed form: a fixed rule with {piece.nodes} nodes on each piece,")
        yield Formula("S", "S", _shown(piece.sin))
        yield Formula("C", "C", _shown(piece.cos))
        low = piece.high
    for condition in average.presumes:
        yield Sentence(f"This presumes {condition}.")


def _interval(low: Expression | None, piece: Piece) -> tuple[str, tuple[Expression, ...]]:
    if low is None:
        assert piece.high is not None
        return "For r < {0}:", (piece.high,)
    return ("For r > {0}:", (low,)) if piece.high is None else ("For {0} < r < {1}:", (low, piece.high))


def _angle(cut: Cut) -> Expression:
    return _shown(from_sympy(cut.phi))


def _shown(formula: Expression) -> Expression:
    return substitute([formula], {symbol(X): symbol("x"), symbol(Y): symbol("y"), symbol(RADIUS): symbol("r")})[0]


def _products(result: Averaged) -> Iterator[Block]:
    lines = []
    written = _amplitude_names(result.system.oscillators)
    for i, equation in enumerate(result.system.equations):
        for powers, (re, im) in equation.products.items():
            names = []
            for name, (m, n) in zip(written, powers, strict=True):
                names += [name] * int(m) + [f"conj({name})"] * int(n) if name else []
            product = " ".join(names)
            if im is ZERO:
                lines.append(Sentence(f"A{i + 1}' contains ({{0}}) {product}", (re,)))
            elif re is ZERO:
                lines.append(Sentence(f"A{i + 1}' contains i ({{0}}) {product}", (im,)))
            else:
                lines.append(Sentence(f"A{i + 1}' contains ({{0}} + i ({{1}})) {product}", (re, im)))
    if lines:
        yield Heading("Means of the coupling")
        yield Sentence(
            "With A = r exp(i theta), products of amplitudes have a mean where one factor A is left over after pairing "
            "A with conj(A):"
            if set(result.system.oscillators.harmonics) == {1}
            else "With A = r exp(i theta), products of amplitudes have a mean where their frequencies add up to that "
            "of the equation:"
        )
        yield from lines
    general = [e.general for e in result.system.equations] + [m.general for m in result.system.means]
    if any(general):
        yield Sentence(
            "Forces that are no polynomials of several oscillators are averaged by fixed rules over the turn."
        )


def _kicks(result: Averaged) -> Iterator[Block]:
    oscillators = result.system.oscillators
    if not oscillators.kicks:
        return
    yield Heading("Kicks")
    yield Sentence(
        f"A kick changes A of its oscillator by {oscillators.small} exp(-i tau) (e - i f/omega), e and f the "
        "changes of position and velocity at the phase tau; it happens once a turn and adds omega/(2 pi) times that."
    )
    for kick in oscillators.kicks:
        way = {"up": "upwards", "down": "downwards"}.get(kick.direction, "in both directions")
        yield Sentence(f"Where {{0}} crosses zero {way}:", (_with_phases(kick.when, oscillators),))
        for name, change in kick.changes.items():
            formula = _with_phases(change, oscillators)
            yield Formula(f"change of {name}", rf"\Delta {latex_name(name)}", formula)


def _friction(result: Averaged) -> Iterator[Block]:
    oscillators = result.system.oscillators
    if not oscillators.responses:
        return
    yield Heading("Dry friction")
    yield Sentence(
        "With f = Re(B exp(i tau)) and m = level/|B|, sign(V) has the first harmonic B/|B| (s + i d). Stuck, m > 1: "
        "s = 1/m, d = 0. Slipping all the time, m < 1/sqrt(1 + pi^2/4): s = 2 m, d = -(4/pi) sqrt(1 - (pi m/2)^2). "
        "Between, V slips for u of each half turn, tan(acos(m)) = (u - sin(u))/(1 - cos(u))."
    )
    for response in oscillators.responses:
        yield Sentence("The level is {0}.", (response.level,))


def _amplitude_names(oscillators: WeakOscillators) -> list[str]:
    """A1, A2, ..., exp(i phase) for rotators; the forcing's amplitude is 1."""
    names = [f"A{j + 1}" for j in range(oscillators.count)]
    return [*names, *("" if p.state is None else f"exp(i {p.state})" for p in oscillators.phasors)]


def _result(result: Averaged) -> Iterator[Block]:
    model = result.model
    yield Heading("Averaged equations")
    if model.description:
        yield Sentence(model.description.replace("{", "{{").replace("}", "}}"))
    names = definition_names(model.definitions)
    for state, right in model.equation_map.items():
        yield equation_of(state, right, names)
    for name, node in model.definitions.items():
        yield Formula(name, latex_name(name), node, {n: o for n, o in names.items() if n is not node})
    for name, node in model.observables.items():
        yield Formula(name, latex_name(name), node, names)
    if model.symmetries:
        yield Sentence("Symmetries: " + ", ".join(s.name for s in model.symmetries) + ".")
