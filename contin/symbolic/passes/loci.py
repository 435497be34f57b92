"""Defining systems of curves in two parameters: from a model, a larger model whose equilibria are its special points.

Each pass appends null vectors (and kappa) to the states and makes one parameter, `free`, a state; another parameter
then varies along the curve. Auxiliary names contain a dot, so they cannot meet a model's own. Vectors are measured in
typical sizes of the states, the new parameters `size.x`, so that nothing depends on their units.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from contin.errors import InputError
from contin.model.expression import ONE, ZERO, Expression, add, div, mul, neg, power, sub, symbol
from contin.model.model import Model
from contin.model.parts import Parameter, State
from contin.symbolic.calculus.derivatives import directional, jacobian
from contin.symbolic.calculus.remove_singularities import remove_singularities

if TYPE_CHECKING:
    from contin.model.model import Model

KAPPA: Final = "kappa."
UNFOLDING: Final = "unfolding."
LENGTH_ROW, BORDER_ROW = "row.length", "row.border"
ROWS = (LENGTH_ROW, BORDER_ROW)  # parameters: factors that bring rows without units of time to the size of the others


def fold_system(model: Model, free: str) -> Model:
    """Folds: F = 0, F_u v = 0, |v| = 1, where F = f (flow) or f(u) - u (map).

    States (u, v, free), 2n + 1. Regular at folds whose quadratic coefficient or transversality is not zero, and at
    cusps and Bogdanov-Takens points (Griewank and Reddien 1984; Kuznetsov, Elements, 3rd ed., sec. 10.4.1).
    """
    return _eigenvalue_system(model, free, ONE if model.kind == "map" else ZERO, "folds")


def flip_system(model: Model, free: str) -> Model:
    """Period doublings of a map: f(u) = u, f_u v = -v, |v| = 1. States (u, v, free)."""
    if model.kind != "map":
        raise InputError("period doublings of equilibria need a map (kind: map)")
    return _eigenvalue_system(model, free, neg(ONE), "period doublings")


def _eigenvalue_system(model: Model, free: str, value: Expression, what: str) -> Model:
    parts = _Parts(model)
    v = parts.vector("v")
    image = parts.along(v)
    eigen = [sub(a, mul(value, b)) for a, b in zip(image, v, strict=True)]
    equations = [*parts.residual, *eigen, mul(symbol(LENGTH_ROW), sub(parts.squared(v), ONE))]
    return parts.model(f"{what} of", ["v"], [], free, equations, [])


def hopf_system(model: Model, free: str) -> Model:
    """Hopf points, kappa = omega^2: f = 0, (J^2 + kappa I) v = 0, |v| = 1, l . v = 0 with l the parameters `border.x`.

    For a map, Neimark-Sacker points with kappa = cos theta: f(u) = u, (J^2 - 2 kappa J + I) v = 0. States (u, v, w,
    kappa, free), 3n + 2, where w = J v: as an unknown it keeps the formulas short. Real throughout, and regular at
    Bogdanov-Takens points, where kappa changes sign: beyond them kappa < 0 and the curve is one of neutral saddles
    (Roose and Hlavacek 1985; Kuznetsov, Elements, sec. 10.4.2). The border l must not be normal to the plane of the two
    critical eigenvectors.
    """
    parts = _Parts(model)
    v, w, border, kappa = parts.vector("v"), parts.vector("w"), parts.vector("border"), symbol(KAPPA)
    once = [sub(a, b) for a, b in zip(parts.along(v), w, strict=True)]
    twice = parts.along(w)
    if model.kind == "map":
        eigen = [add(c, mul(-2, kappa, b), a) for a, b, c in zip(v, w, twice, strict=True)]
    else:
        eigen = [add(c, mul(kappa, a)) for a, c in zip(v, twice, strict=True)]
    normal = add(*(div(mul(a, b), mul(s, s)) for a, b, s in zip(border, v, parts.sizes, strict=True)))
    length = mul(symbol(LENGTH_ROW), sub(parts.squared(v), ONE))
    equations = [*parts.residual, *once, *eigen, mul(symbol(BORDER_ROW), normal), length]
    what = "Neimark-Sacker points of" if model.kind == "map" else "Hopf points of"
    return parts.model(what, ["v", "w"], [KAPPA], free, equations, ["border"])


def branch_point_system(model: Model, other: str, free: str) -> Model:
    """Branch points: F + b w = 0, F_u^T w = 0, <w, a F_other + c F_free> = 0, |w| = 1.

    States (u, w, b, free), 2n + 2; a, c are the parameters `across.1`, `across.2`. Branch points that something forces
    (a symmetry, an invariant subspace, a solution that is always there) form a curve in two parameters with b = 0;
    others are met at isolated parameters, and b, the unfolding parameter, leaves zero along the curve of this system: f
    has to be perturbed by b w to keep them (Moore 1980; Govaerts, Numerical Methods for Bifurcations, sec. 8.2). (a, c)
    is a direction of the parameters across the curve: on a forced curve both products vanish.
    """
    parts = _Parts(model)
    w, b = parts.vector("w"), symbol(UNFOLDING)
    total = add(*(mul(a, f) for a, f in zip(w, parts.residual, strict=True)))
    gradient = jacobian([total], [*model.state_names, other, free])[0]
    unfolded = [add(f, mul(b, s, s, a)) for f, s, a in zip(parts.residual, parts.sizes, w, strict=True)]
    across = add(mul(symbol("across.1"), gradient[-2]), mul(symbol("across.2"), gradient[-1]))
    length = sub(add(*(power(mul(a, s), 2) for a, s in zip(w, parts.sizes, strict=True))), ONE)
    equations = [*unfolded, *gradient[:-2], across, length]
    return parts.model("branch points of", ["w"], [UNFOLDING], free, equations, [], ["across.1", "across.2"])


class _Parts:
    """Pieces that all defining systems share."""

    def __init__(self, model: Model) -> None:
        if model.forcing is not None:
            raise InputError("a forced system has no equilibria: continue its periodic orbits instead")
        self.source = model
        self.names = model.state_names
        self.f = remove_singularities(model.equations)
        fixed = [symbol(name) for name in self.names]
        self.residual = [sub(f, u) for f, u in zip(self.f, fixed, strict=True)] if model.kind == "map" else self.f
        self.sizes = self.vector("size")

    def vector(self, prefix: str) -> list[Expression]:
        return [symbol(f"{prefix}.{name}") for name in self.names]

    def along(self, direction: Sequence[Expression]) -> list[Expression]:
        """f_u d"""
        return directional(self.f, self.names, [direction])

    def squared(self, v: Sequence[Expression]) -> Expression:
        return add(*(power(div(a, s), 2) for a, s in zip(v, self.sizes, strict=True)))

    def model(
        self, what: str, vectors: Sequence[str], scalars: Sequence[str], free: str, equations: Sequence[Expression],
        borders: Sequence[str], further: Sequence[str] = (),
    ) -> Model:  # fmt: skip
        source = self.source
        extra = [f"{prefix}.{name}" for prefix in vectors for name in self.names]
        states = [*source.states, *(State(name, ZERO) for name in (*extra, *scalars, free))]
        added = [f"{prefix}.{name}" for prefix in ("size", *borders) for name in self.names]
        added = [*ROWS, *added]
        parameters = [p for p in source.parameters if p.name != free]
        parameters += [Parameter(name, ONE) for name in (*added, *further)]
        return Model.from_parts(
            name=f"{what} {source.name}",
            states=tuple(states),
            parameters=tuple(parameters),
            equations=tuple(equations),
        )
