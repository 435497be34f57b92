"""Symmetries of averaged forms: those that the model declares, the ambiguity of (r, theta), and shifts of time."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from contin.model.expression import (
    ONE,
    PI,
    ZERO,
    Expression,
    add,
    mul,
    neg,
    number,
    sub,
    symbol,
)
from contin.model.parts import Symmetry
from contin.symbolic.averaging.form_polar import polar_names
from contin.symbolic.averaging.forms import AveragedForm, ratio
from contin.symbolic.averaging.weak import WeakOscillators


def averaged_symmetries(form: AveragedForm, oscillators: WeakOscillators) -> list[Symmetry]:
    """Declared symmetries that send every oscillator to plus or minus an oscillator; others have no averaged form."""
    found = []
    for symmetry in oscillators.model.symmetries:
        moves = _signed_permutation(symmetry, oscillators)
        if moves is None:
            continue
        images = _images(form, moves, oscillators)
        images |= {s.name: symmetry.map[s.name] for s in oscillators.slow if s.name in symmetry.map}
        if images:
            found.append(Symmetry(symmetry.name, images))
    return found


def _signed_permutation(symmetry: Symmetry, oscillators: WeakOscillators) -> list[tuple[int, int]] | None:
    """[(j, sign)]: oscillator i becomes sign * oscillator j."""
    names = [(p.position, p.velocity) for p in oscillators.pairs]
    moves = []
    for position, velocity in names:
        images = [symmetry.map.get(n, symbol(n)) for n in (position, velocity)]
        match = next(
            (
                (j, sign)
                for j, pair in enumerate(names)
                for sign in (1, -1)
                if all(image is mul(number(sign), symbol(n)) for image, n in zip(images, pair, strict=True))
            ),
            None,
        )
        if match is None:
            return None
        moves.append(match)
    return moves if sorted(j for j, _ in moves) == list(range(len(names))) else None


def _images(
    form: AveragedForm, moves: Sequence[tuple[int, int]], oscillators: WeakOscillators
) -> dict[str, Expression]:
    """The substitution in the form's states; empty where it moves nothing."""
    images: dict[str, Expression] = {}
    if form.name == "cartesian":
        for i, (j, sign) in enumerate(moves):
            for part in ("u", "v"):
                images[f"{part}{i + 1}"] = mul(number(sign), symbol(f"{part}{j + 1}"))
    elif form.name == "stokes":
        relative = number(moves[0][1] * moves[1][1])
        swapped = moves[0][0] == 1
        images = {
            "S1": neg(symbol("S1")) if swapped else symbol("S1"),
            "S2": mul(relative, symbol("S2")),
            "S3": mul(relative, neg(symbol("S3")) if swapped else symbol("S3")),
        }
    else:
        images = _polar_images(moves, oscillators)
    return {name: image for name, image in images.items() if image is not symbol(name)}


def _polar_images(moves: Sequence[tuple[int, int]], oscillators: WeakOscillators) -> dict[str, Expression]:
    forced = oscillators.is_forced
    radii, phases = polar_names(len(moves), forced)
    theta: list[Expression] = [*(() if forced else (ZERO,)), *(symbol(name) for name in phases)]
    images: dict[str, Expression] = {name: symbol(radii[j]) for name, (j, _) in zip(radii, moves, strict=True)}
    turned = [add(theta[j], PI) if sign < 0 else theta[j] for j, sign in moves]
    if forced:
        return {**images, **dict(zip(phases, turned, strict=True))}
    for name, angle, harmonic in zip(phases, turned[1:], oscillators.harmonics[1:], strict=False):
        images[name] = sub(angle, mul(ratio(oscillators, harmonic), turned[0]))
    return images


def gauge_symmetries(form: AveragedForm, oscillators: WeakOscillators) -> list[Symmetry]:
    """(r, theta) ~ (-r, theta + pi): symmetries of every averaged system of this form whose formulas are odd.

    And where the first oscillator turns h_1 > 1 times in a period, the phases after one of its turns; with forcing that
    turns h > 1 times, the same after one period of the forcing.
    """
    forced = oscillators.is_forced
    if form.name != "polar":
        return _after_a_period(oscillators) if forced else []
    radii, phases = polar_names(oscillators.count, forced)
    if not form.angles:
        return [Symmetry("reflection", {"r": neg(symbol("r"))})]
    if forced:
        names = ["gauge"] if len(radii) == 1 else [f"gauge{i + 1}" for i in range(len(radii))]
        found = [
            Symmetry(name, {r: neg(symbol(r)), psi: add(symbol(psi), PI)})
            for name, r, psi in zip(names, radii, phases, strict=True)
        ]
        return [*found, *_after_a_period(oscillators, form.angles)]
    shares = [ratio(oscillators, h) for h in oscillators.harmonics[1 : len(radii)]]
    shares += [ratio(oscillators, s.turns) for s in oscillators.slow if s.turns]
    shifts = [PI if share is ONE else mul(neg(share), PI) for share in shares]
    first: dict[str, Expression] = {radii[0]: neg(symbol(radii[0]))}
    first |= {p: add(symbol(p), shift) for p, shift in zip(form.angles, shifts, strict=True)}
    found = [Symmetry("gauge" if len(radii) == 2 else "gauge1", first)]
    if len(radii) > 2:
        for radius, phase in zip(radii[1:], phases, strict=True):
            images = {radius: neg(symbol(radius)), phase: add(symbol(phase), PI)}
            found.append(Symmetry(f"gauge{radius[1:]}", images))
    if oscillators.harmonics[0] > 1:
        turns = {p: add(symbol(p), mul(number(2), s, PI)) for p, s in zip(form.angles, shares, strict=True)}
        found.append(Symmetry("turn", turns))
    return found


def _after_a_period(oscillators: WeakOscillators, angles: Sequence[str] = ()) -> list[Symmetry]:
    """A_j -> exp(2 pi i h_j/h) A_j, h the harmonic of the forcing; in the cartesian form for h = 2 only."""
    h = next(p.pair.harmonic for p in oscillators.phasors if p.state is None)
    own = oscillators.harmonics[: oscillators.count]
    turns = [s.turns for s in oscillators.slow if s.turns]
    if h == 1 or (not angles and h != 2):
        return []
    if not angles:
        odd = [i + 1 for i, k in enumerate(own) if k % 2]
        images = {f"{part}{i}": neg(symbol(f"{part}{i}")) for i in odd for part in ("u", "v")}
        phases = [s.name for s in oscillators.slow if s.turns % 2]
        images |= {name: add(symbol(name), PI) for name in phases}
    else:
        images = {
            name: add(symbol(name), mul(number(Fraction(2 * k, h)), PI))
            for name, k in zip(angles, (*own, *turns), strict=True)
            if k % h
        }
    return [Symmetry("period", images)] if images else []
