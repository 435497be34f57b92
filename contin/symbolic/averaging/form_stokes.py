"""Stokes form of two oscillators: the circle symmetry divided out, smooth away from total rest.

S1 = |A1|^2 - |A2|^2,  S2 = 2 Re(A1 conj A2),  S3 = 2 Im(A1 conj A2),  S0 = |A1|^2 + |A2|^2 = |(S1, S2, S3)|
"""

from __future__ import annotations

from contin.model.expression import ZERO, Expression, add, call, compare, div, if_, mul, neg, number, power, sub, symbol
from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, plus, times, to_power
from contin.symbolic.averaging.forms import AveragedForm, general_parts, needs_frame
from contin.symbolic.averaging.resonant import Powers
from contin.symbolic.averaging.squared_radius import rates_over_radius

STATES = ("S1", "S2", "S3")


def stokes_form(system: SlowSystem) -> AveragedForm:
    """S1', S2', S3' in slow time."""
    s1, s2, s3 = (symbol(name) for name in STATES)
    total = call("sqrt", add(power(s1, number(2)), power(s2, number(2)), power(s3, number(2))))
    half = number(0.5)
    squares = (add(mul(half, total), mul(half, s1)), sub(mul(half, total), mul(half, s1)))
    definitions = {"S0": total, "R1": squares[0], "R2": squares[1]}
    for i in range(2):
        for j in system.equations[i].radial:
            rate = rates_over_radius(system.rates(i, j), squares[j])
            suffix = f"{i + 1}" if i == j else f"{i + 1}{j + 1}"
            definitions |= {n + suffix: part for n, part in zip(("growth", "turn"), rate, strict=True) if part.args}
    product: Complex = (mul(half, s2), mul(half, s3))  # P = A1 conj A2
    own: list[Expression] = []  # (|A_i|^2)'
    cross: Complex = (ZERO, ZERO)  # P'
    for i in range(2):
        change, mixed = _parts(system, i, squares, product)
        own.append(mul(number(2), change))
        cross = plus(cross, mixed)
    equations = (_flat(own[0], neg(own[1])), mul(number(2), cross[0]), mul(number(2), cross[1]))
    words = ("|A1|^2 - |A2|^2", "2 Re(A1 conj A2)", "2 Im(A1 conj A2) = -2 r1 r2 sin(psi)")
    valid = "smooth except at total rest S1 = S2 = S3 = 0; there use the form cartesian"
    observables = _observables(s1, s2, s3, total)
    return AveragedForm(
        "stokes", STATES, words, tuple(_flat(e) for e in equations), observables, (), valid, definitions=definitions,
        beyond="The form stokes is not smooth at total rest; the form cartesian goes through it.",
    )  # fmt: skip


def _observables(s1: Expression, s2: Expression, s3: Expression, total: Expression) -> dict[str, Expression]:
    """r1, r2 and psi; the smaller amplitude without the cancellation in S0 - |S1|."""
    across = add(power(s2, number(2)), power(s3, number(2)))
    larger = mul(number(0.5), add(total, call("abs", s1)))
    smaller = div(across, mul(number(2), add(total, call("abs", s1))))
    first = compare(">=", s1, ZERO)
    return {
        "r1": call("sqrt", if_(first, larger, smaller)),
        "r2": call("sqrt", if_(first, smaller, larger)),
        "psi": call("atan2", neg(s3), s2),
    }


def _flat(*terms: Expression) -> Expression:
    flat: list[Expression] = []
    for term in terms:
        flat += term.args if term.op == "add" else (term,)
    return add(*flat)


def _parts(
    system: SlowSystem, i: int, squares: tuple[Expression, Expression], product: Complex
) -> tuple[Expression, Complex]:
    """Re(conj(A_i) A_i') and the contribution of A_i' to P' = A1' conj A2 + A1 conj A2'."""
    change: Expression = ZERO
    mixed: Complex = (ZERO, ZERO)
    equation = system.equations[i]
    for powers, c in equation.products.items():
        change = add(change, times(c, _invariant(_with(powers, i, conjugated=True), squares, product))[0])
        mixed = plus(mixed, _into_product(c, powers, i, squares, product))
    for j in equation.radial:
        rate = rates_over_radius(system.rates(i, j), squares[j])
        powers = tuple((1, 0) if k == j else (0, 0) for k in range(2))
        change = add(change, times(rate, _invariant(_with(powers, i, conjugated=True), squares, product))[0])
        mixed = plus(mixed, _into_product(rate, powers, i, squares, product))
    if needs_frame(system, i):
        # a frame in which A1 is real and positive
        root = call("sqrt", squares[0])
        frame: list[Complex] = [(root, ZERO), (div(product[0], root), div(neg(product[1]), root))]
        value = general_parts(system, i, frame)
        change = add(change, times(conjugate(frame[i]), value)[0])
        mixed = plus(mixed, times(value, conjugate(frame[1])) if i == 0 else times(frame[0], conjugate(value)))
    return change, mixed


def _into_product(
    c: Complex, powers: Powers, i: int, squares: tuple[Expression, Expression], product: Complex
) -> Complex:
    """c M conj(A2) for i = 0, A1 conj(c M) for i = 1, with M the product of amplitudes of these powers."""
    if i == 0:
        return times(c, _invariant(_with(powers, 1, conjugated=True), squares, product))
    return times(conjugate(c), conjugate(_invariant(_with(powers, 0, conjugated=True), squares, product)))


def _with(powers: Powers, k: int, conjugated: bool) -> Powers:
    """The powers after one more factor A_k or conj(A_k)."""
    m, n = powers[k]
    changed = (m, n + 1) if conjugated else (m + 1, n)
    return tuple(changed if j == k else p for j, p in enumerate(powers))


def _invariant(powers: Powers, squares: tuple[Expression, Expression], product: Complex) -> Complex:
    """A product of amplitudes with as many conj as plain factors, by |A1|^2, |A2|^2 and P."""
    (m1, n1), (m2, n2) = powers
    shift = int(m1 - n1)
    size = mul(power(squares[0], number(min(m1, n1))), power(squares[1], number(min(m2, n2))))
    phase = to_power(product if shift >= 0 else conjugate(product), abs(shift))
    return mul(size, phase[0]), mul(size, phase[1])
