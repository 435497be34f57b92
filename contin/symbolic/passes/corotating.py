"""Models with a circle symmetry seen from a frame that rotates with the state: relative equilibria become equilibria.

A model u' = f(u) that commutes with a rotation u' = xi(u) has rotating waves f(u) = rate * xi(u). In the frame
that turns with the mean rate of the state itself,

    u' = f(u) - rate(u) xi(u),    rate(u) = (<xi, f> + phase(u)) / <xi, xi>,

these are equilibria with the unknown rate already eliminated, and the phase condition phase(u) = 0 makes them isolated.
The shape of the solution does not depend on the frame: the eigenvalues are those of the rotating wave, with the trivial
one replaced by a negative one (Beyn and Thuemmler, Freezing solutions of equivariant evolution equations, 2004).

Orbits need another frame, that of `of_orbits`: in this one the angle of an orbit swings about the phase condition, with
which it cannot always keep up, so that families of orbits have folds of the frame's own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contin.errors import InputError
from contin.machine import elementary
from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import ZERO, Expression, add, div, mul, neg, number, power, split_coefficient, sub, symbol
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.model.parts import State
from contin.model.rotation import check_rotation
from contin.model.source import CallSource, Problems
from contin.records import Fields, Record
from contin.symbolic.calculus.derivatives import sparse_jacobian
from contin.symbolic.passes.formulas import read
from contin.symbolic.passes.holding import holds

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Rotation:
    """What belongs to a model in a frame: the rotation that the frame follows, and what it was made from.

    It is kept with that very model: of equal ones, one may be freed before the other.
    """

    generator: tuple[Expression, ...]
    written: Model


def corotate(model: Model, rotation: Record | None = None) -> Model:
    """`corotating` as a pass; `rotation` declares the circle symmetry where the model does not, e.g. {u: -v, v: u}."""
    if rotation is None:
        return corotating(model)
    names = [*model.state_names, *model.parameter_names]
    declared = {n: read(v, names, f"rotation: {n}") for n, v in rotation.items()}
    unknown = [n for n in declared if n not in model.state_names]
    if unknown:
        raise InputError(
            f"rotation: {model.name} has no state {unknown[0]!r}: there are {', '.join(model.state_names)}"
        )
    problems = Problems(CallSource("rotation"))
    parts: Fields = {
        "states": model.states,
        "parameters": model.parameters,
        "equations": model.equations,
        "rotation": declared,
    }
    check_rotation(parts, problems)
    problems.raise_if_any()
    return corotating(model.replace(rotation=declared))


def corotating(model: Model) -> Model:
    """The same model in the frame that turns with the state; states and parameters keep their names.

    Its equilibria are the relative equilibria of `model`, normalised by b = 0, a > 0 for the first pair of states a, b
    that the rotation turns into each other. Not defined where the rotation moves nothing (total rest).

    Raises
    ------
    InputError
        The model declares no rotation, or none that turns a pair of states.
    """
    if not model.rotation:
        raise InputError(f"model {model.name} declares no rotation; add, for example, rotation: {{u: -v, v: u}}")
    return kept_with(model, "corotating", lambda: _in_frame(model, _keeping_up(model)))


def _keeping_up(model: Model) -> tuple[Expression, ...]:
    generator = [model.rotation.get(name, ZERO) for name in model.state_names]
    rate = rotation_rate(model, model.equations, phase_condition(model))
    return tuple(sub(f, mul(rate, xi)) for f, xi in zip(model.equations, generator, strict=True))


def _in_frame(model: Model, equations: tuple[Expression, ...]) -> Model:
    result = model.replace(states=_normalised(model), equations=equations, rotation={})
    # the phase condition distinguishes two states, so a symmetry that exchanges them may be lost
    result = result.replace(symmetries=tuple(s for s in model.symmetries if holds(result, s)))
    frame = _Rotation(tuple(model.rotation.get(name, ZERO) for name in model.state_names), model)
    kept_with(result, "frame", lambda: frame)
    return result


def _frame_of(model: Model) -> _Rotation | None:
    nothing: _Rotation | None = None
    return kept_with(model, "frame", lambda: nothing)


def of_orbits(model: Model) -> Model:
    """The frame for periodic orbits in place of that of `corotating`; a model in no such frame is its own.

    It turns with the pair of states (a, b), xi_a = -c b, xi_b = c a, of the phase condition alone:

        u' = f - rate xi,    c rate = (a f_b - b f_a + a b) / (a^2 + b^2).

    The pair's angle falls to 0 whatever the rest of the state does: b = 0 is invariant, and on it the flow is the
    quotient by the rotation. Orbits that return turned by an angle (relative periodic orbits) are the periodic orbits
    there, one for one, with the multipliers of the full space but the rotation's, and the period of the return.
    """
    frame = _frame_of(model) if isinstance(model, Model) else None
    if frame is None:
        return model
    written = frame.written
    return kept_with(written, "orbits", lambda: _in_frame(written, _turning_with_the_pair(written)))


def _turning_with_the_pair(model: Model) -> tuple[Expression, ...]:
    """f - rate xi; for the pair itself without the terms that cancel, so that b = 0 stays 0 whatever rounding does."""
    a, b, speed = turned_pair(model)
    f = dict(zip(model.state_names, model.equations, strict=True))
    x, y = symbol(a), symbol(b)
    square = add(power(x, number(2)), power(y, number(2)))
    fall = div(mul(x, y), square)  # of the pair's angle
    rate = div(add(div(add(mul(x, f[b]), neg(mul(y, f[a]))), square), fall), speed)
    growth = div(add(mul(x, f[a]), mul(y, f[b])), square)
    pair = {a: add(mul(x, growth), mul(y, fall)), b: sub(mul(y, growth), mul(x, fall))}
    every = zip(model.state_names, model.equations, strict=True)
    return tuple(pair.get(name) or sub(rule, mul(rate, model.rotation.get(name, ZERO))) for name, rule in every)


def frame_generator(model: Model, parameters: Mapping[str, float]) -> Array | None:
    """Matrix (n, n) of the linear rotation xi(u) = G u that the frame of a corotating model follows; else None."""
    frame = _frame_of(model)
    if frame is None:
        return None
    names = list(model.state_names)
    return _matrix(frame.generator, names, {**parameters, **dict.fromkeys(names, 0.0)})


def _matrix(generator: Sequence[Expression], names: Sequence[str], point: Mapping[str, float]) -> Array:
    matrix = np.zeros((len(names), len(names)))
    for (i, j), entry in sparse_jacobian(generator, names).items():
        matrix[i, j] = evaluate(entry, point)
    return matrix


def _normalised(model: Model) -> tuple[State, ...]:
    """The states, with the one that the phase condition makes positive kept so."""
    first = turned_pair(model)[0]
    text = f"The frame turns with {first}, which is 0 here; rest is an equilibrium of its own: start there."
    return tuple(replace(s, minimum=ZERO, beyond=text) if s.name == first else s for s in model.states)


def rotation_rate(model: Model, equations: Sequence[Expression], phase: Expression = ZERO) -> Expression:
    """(<xi, f> + phase)/<xi, xi>: the rate at which the state turns."""
    generator = [model.rotation.get(name, ZERO) for name in model.state_names]
    along = add(*(mul(xi, f) for xi, f in zip(generator, equations, strict=True) if xi is not ZERO), phase)
    return div(along, add(*(power(xi, number(2)) for xi in generator if xi is not ZERO)))


def phase_condition(model: Model) -> Expression:
    """c a b for the first pair with xi_a = -c b, xi_b = c a: zero and increasing along the rotation at b = 0."""
    a, b, speed = turned_pair(model)
    return mul(speed, symbol(a), symbol(b))


def turned_pair(model: Model) -> tuple[str, str, Expression]:
    """(a, b, c) with xi_a = -c b, xi_b = c a."""
    for a, xi in model.rotation.items():
        factor, rest = split_coefficient(xi)
        if rest.op == "symbol" and rest is not symbol(a):
            b = str(rest.value)
            if model.rotation.get(b) is mul(number(-factor), symbol(a)):
                return a, b, neg(number(factor))
    raise InputError(f"model {model.name}: the rotation turns no pair of states (a: -b, b: a)")


def is_moved(model: Model, u: Array, p: Array) -> bool:
    """True where the rotation moves the point u: rotating waves start there, rest does not."""
    point = {**dict(zip(model.state_names, u, strict=True)), **dict(zip(model.parameter_names, p, strict=True))}
    return any(abs(float(v)) > 0 for v in evaluate_all(model.rotation.values(), point))


def frame_for(model: Model, u: Array, p: Array) -> tuple[Model, Array]:
    """The model in which the state u can be an equilibrium, and u in it.

    Where a declared rotation moves u: the corotating model, and u turned to the phase that it keeps.
    """
    if not getattr(model, "rotation", None) or not is_moved(model, u, p):
        return model, u
    return corotating(model), _turned(model, u, p)


def _turned(model: Model, u: Array, p: Array) -> Array:
    """u rotated until b = 0, a > 0 for the pair of the phase condition; the rotation must be linear."""
    from scipy.linalg import expm

    a, b, speed = turned_pair(model)
    names = list(model.state_names)
    values = dict(zip(model.parameter_names, map(float, p), strict=True))
    here = dict(zip(names, map(float, u), strict=True))
    angle = -elementary.atan2(here[b], here[a]) / float(evaluate(speed, values))
    if angle == 0.0:
        return u
    matrix = _matrix([model.rotation.get(n, ZERO) for n in names], names, {**values, **here})
    return np.asarray(expm(angle * matrix) @ u)
