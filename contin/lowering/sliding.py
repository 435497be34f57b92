"""A piecewise flow beside one of its surfaces of discontinuity: the formulas of either side, and the sliding motion.

On h(u, p) = 0 with the fields f- (h < 0) and f+ (h > 0), L the derivative of h along a field, the Filippov field is

    f_s = f- + w (f+ - f-),  w = L f- / (L f- - L f+),

tangent to the surface; motion slides where 0 < w < 1 (Filippov 1988; di Bernardo, Budd, Champneys and Kowalczyk,
Piecewise-smooth Dynamical Systems, 2008, sec. 2.2). Attracting: L f- > L f+.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from contin.errors import InputError
from contin.lowering.pieces import MODE, freeze
from contin.model.expression import Expression, add, div, mul, number, power, sub, substitute, symbol
from contin.model.model import Model
from contin.model.printing import to_text
from contin.symbolic.calculus.derivatives import sparse_jacobian
from contin.symbolic.calculus.remove_singularities import remove_singularities
from contin.symbolic.passes.holding import holds

WEIGHT: Final = "weight"  # observable of the sliding model


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface and the equations with the formula of either side, wherever the state is."""

    function: Expression
    lower: tuple[Expression, ...]
    upper: tuple[Expression, ...]
    frozen: tuple[Expression, ...]  # the equations with modes
    functions: tuple[Expression, ...]  # of all surfaces

    @property
    def text(self) -> str:
        """Such as 'x - 1 = 0'."""
        return f"{to_text(self.function)} = 0"


def surfaces_of(model: Model) -> list[Surface]:
    """Every surface at which some equation changes its formula; removable singularities are removed from the sides."""
    frozen, functions = freeze(remove_singularities(model.equations), model.state_names)
    found = []
    for k, function in enumerate(functions):
        signs = {symbol(MODE.format(j)): h for j, h in enumerate(functions) if j != k}  # modes stand in `... > 0` only
        sides = [
            tuple(substitute(frozen, signs | {symbol(MODE.format(k)): number(side)}))
            for side in (-1, 1)
        ]
        found.append(Surface(function, sides[0], sides[1], tuple(frozen), tuple(functions)))
    return found


def side_model(model: Model, surface: Surface, upper: bool) -> Model:
    """The flow with the formulas of one side."""
    return _plain(model, surface.upper if upper else surface.lower)


def held_model(model: Model, surface: Surface, signs: Sequence[int]) -> Model:
    """The smooth flow with the formulas that belong to these signs of all surfaces, in their order."""
    modes = {symbol(MODE.format(j)): number(sign) for j, sign in enumerate(signs)}
    return _plain(model, substitute(surface.frozen, modes))


def sliding_model(model: Model, surface: Surface, rate: float) -> Model:
    """The flow whose equilibria are the pseudo-equilibria on a surface: f_s - r (L f- - L f+) h grad h / |grad h|^2.

    The last term is zero on the surface and draws the state to it (or drives it away, where sliding is repelling): the
    eigenvalues are those of the sliding motion and -r (L f- - L f+), r > 0 the `rate`. Observable WEIGHT: w. States and
    parameters keep their names. Raises InputError where the surface does not depend on the states.
    """
    h, names = surface.function, model.state_names
    gradient = {names[j]: slope for (_, j), slope in sparse_jacobian([h], names).items()}
    if not gradient:
        raise InputError(f"{surface.text} does not depend on the states: nothing slides there")
    below, above = (_along(names, gradient, side) for side in (surface.lower, surface.upper))
    difference = sub(below, above)
    weight = div(below, difference)
    square = add(*(power(slope, number(2)) for slope in gradient.values()))
    pull = div(mul(number(rate), difference, h), square)
    equations = []
    for name, low, high in zip(names, surface.lower, surface.upper, strict=True):
        field = add(low, mul(weight, sub(high, low)))
        equations.append(sub(field, mul(pull, gradient[name])) if name in gradient else field)
    kept = {name: formula for name, formula in model.observables.items() if name != WEIGHT}
    observables = {**dict(zip(kept, remove_singularities(list(kept.values())), strict=True)), WEIGHT: weight}
    result = _plain(model, equations).replace(observables=observables)
    return result.replace(symmetries=tuple(s for s in model.symmetries if holds(result, s)))


def _plain(model: Model, equations: Sequence[Expression]) -> Model:
    """The model with other equations, and without what may not hold for them."""
    return model.replace(equations=tuple(equations), symmetries=(), rotation={}, expect=(), averaging=None)


def _along(names: Sequence[str], gradient: dict[str, Expression], field: Sequence[Expression]) -> Expression:
    return add(*(mul(gradient[name], f) for name, f in zip(names, field, strict=True) if name in gradient))
