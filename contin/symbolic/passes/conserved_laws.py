"""Linear conserved quantities: c with c . f(x, p, t) = 0 (a map: c . F(x, p) = c . x) for all states and parameters.

Whether there are any is decided by numbers first, which costs one evaluation of the equations at some n random states
and a singular value decomposition: models without any pay nothing more. Then the equations are multiplied out
(`contin.symbolic.calculus.monomials`), and c is an exact rational left null vector of the matrix of their coefficients
(Horn and Jackson, Arch. Rational Mech. Anal. 47, 1972), which proves the law wherever the equations are defined. Rows
may be divided by monomials in parameters first: amounts in compartments of volumes V and W have c = (V, W). What only
numbers show is made rational and tried at more random points; its error is kept.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import ContinError
from contin.machine import elementary
from contin.model.expression import Expression, add, mul, number, postorder, power, sub, symbol
from contin.model.model import Model
from contin.model.parts import TIME
from contin.model.vocabulary import PIECEWISE
from contin.symbolic.calculus.echelon import echelon, fractions
from contin.symbolic.calculus.monomials import Monomial, Monomials, Terms, common_monomial, divided
from contin.symbolic.calculus.sampling import sample
from contin.symbolic.passes.rational_kernels import Row, left_kernel, plain_basis

LARGEST: Final = 400  # states; larger models are not looked at
MORE: Final = 12  # samples than states
SPREAD: Final = 1.5  # decimal powers around a natural size in which states are drawn
WIDE: Final = 4.0  # ... of either sign, where the equations are piecewise: a law holds on both sides of every surface
NOTHING: Final = 1e-9  # singular value, of the largest, that is zero but for rounding
CHECKS: Final = 200  # points at which a law that only numbers show is tried
AGREES: Final = 1e-10  # ... and its largest relative error there
LARGEST_WHOLE: Final = 1000  # denominator of coefficients that numbers give


@dataclass(frozen=True)
class Law:
    """sum of coefficient * state is constant; the coefficients are numbers or monomials in the parameters.

    error : 0 where the law is exact, else the largest relative error at `CHECKS` random points.
    """

    coefficients: Mapping[str, Expression]
    error: float = 0.0


def conserved_laws(model: Model) -> tuple[Law, ...]:
    """A basis of the linear conserved quantities of a flow or map; none above `LARGEST` states, or with masses."""
    names = model.state_names
    if model.kind not in ("flow", "map") or model.mass or not 0 < len(names) <= LARGEST:
        return ()
    rates = rates_of(model)
    draws = _Draws(model)
    suspects = _null_space(rates, draws, varied=False)
    if suspects is None or not suspects.shape[1]:
        return ()
    rows = [i for i in range(len(names)) if np.any(np.abs(suspects[i]) > NOTHING)]
    wanted = suspects.shape[1]
    laws = _exact(rates, rows, names, model.parameter_names, wanted)
    if len(laws) < wanted:
        laws += _by_numbers(rates, draws, names, laws)
    return tuple(laws)


def rates_of(model: Model) -> list[Expression]:
    """f of a flow, F(x) - x of a map."""
    if model.kind == "map":
        return [sub(f, symbol(n)) for n, f in zip(model.state_names, model.equations, strict=True)]
    return list(model.equations)


class _Draws:
    """Random states and parameters of their natural sizes and signs; always the same ones."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.chance = np.random.default_rng(7)
        try:
            self.u, self.p = model.start_point()
        except ContinError:  # a start that is not finite says nothing of sizes
            self.u, self.p = np.zeros(len(model.state_names)), np.ones(len(model.parameter_names))

    def points(self, count: int, varied: bool, anywhere: bool = False) -> dict[str, Array]:
        """Values of every symbol, (count,) each; `varied`: parameters too; `anywhere`: of either sign and all sizes."""
        usual = float(np.abs(self.u).max(initial=0.0)) or 1.0
        found = {}
        for name, value in zip(self.model.state_names, self.u, strict=True):
            spread = WIDE if anywhere else SPREAD
            found[name] = (value or usual) * elementary.pow(10.0, self.chance.uniform(-spread, spread, count))
            if anywhere:
                found[name] *= self.chance.choice((-1.0, 1.0), count)
        for name, value in zip(self.model.parameter_names, self.p, strict=True):
            factor = elementary.pow(10.0, self.chance.uniform(-0.5, 0.5, count)) if varied else np.ones(count)
            found[name] = factor * (value if value or not varied else 1.0)
        found[TIME] = self.chance.uniform(0.0, 10.0, count)
        return found


def _relative(rates: Sequence[Expression], env: Mapping[str, Array], count: int) -> Array:
    """Rates at points (at most count, n), each row divided by its largest; rows without a value, or of zeros, go."""
    table = np.column_stack([np.broadcast_to(v, count) for v in sample(rates, env)])
    size = np.abs(table).max(axis=1)
    good = np.isfinite(size) & (size > 0.0)
    return np.asarray(table[good] / size[good, None])


def _values(rates: Sequence[Expression], draws: _Draws, count: int, varied: bool) -> Array | None:
    """Finite rates at random points, (at least count, n), each row divided by its largest; None where few are."""
    kept = np.empty((0, len(rates)))
    for _ in range(4):
        kept = np.vstack([kept, _relative(rates, draws.points(count, varied), count)])
        if len(kept) >= count or not len(kept):
            break
    return kept if len(kept) >= count else None


def _null_space(rates: Sequence[Expression], draws: _Draws, varied: bool) -> Array | None:
    """Orthonormal columns c, up to a scale of each state, with rates . c = 0 at random points: (n, k)."""
    n = len(rates)
    table = _values(rates, draws, n + MORE, varied)
    if table is None:
        return None
    size = np.abs(table).max(axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, singular, right = np.linalg.svd(table / size, full_matrices=True)
    rank = int(np.sum(singular > NOTHING * max(float(singular.max(initial=0.0)), 1e-300)))
    return np.asarray(right[rank:].T / size[:, None])


def _exact(
    rates: Sequence[Expression], rows: Sequence[int], names: Sequence[str], parameters: Sequence[str], wanted: int
) -> list[Law]:
    """Laws that the equations, multiplied out, show; those with plain numbers first."""
    monomials = Monomials()
    expanded = monomials.expand([rates[i] for i in rows])
    known = set(parameters)

    def of_parameters(monomial: Monomial, signs: Sequence[int]) -> Monomial:
        return tuple((a, e) for a, e in monomial if monomials.symbol(a) in known and (1 if e > 0 else -1) in signs)

    found: list[Law] = []
    independent = np.empty((0, len(names)))
    chance = np.random.default_rng(11).uniform(1.0, 2.0, len(parameters))
    values = dict(zip(parameters, chance.tolist(), strict=True))
    for signs in ((), (-1,), (-1, 1)):  # divide by nothing; by denominators such as volumes; by all of it
        scales = [of_parameters(common_monomial(t), signs) for t in expanded]
        for row in _kernel([divided(t, s) for t, s in zip(expanded, scales, strict=True)]):
            coefficients = _coefficients(row, rows, scales, names, monomials)
            vector = np.zeros(len(names))
            for name, c in coefficients.items():
                vector[names.index(name)] = float(sample([c], values)[0]) if parameters else float(sample([c], {})[0])
            more = np.vstack([independent, vector / np.abs(vector).max()])
            if np.linalg.matrix_rank(more, tol=1e-9) == len(more):
                independent = more
                found.append(Law(coefficients))
        if len(found) >= wanted:
            break
    return found


def _kernel(table: Sequence[Terms]) -> list[Row]:
    columns: dict[Monomial, dict[int, Fraction]] = {}
    for i, terms in enumerate(table):
        for monomial, c in terms.items():
            columns.setdefault(monomial, {})[i] = c
    return plain_basis(left_kernel(list(columns.values()), len(table)))


def _coefficients(
    row: Row, rows: Sequence[int], scales: Sequence[Monomial], names: Sequence[str], monomials: Monomials
) -> dict[str, Expression]:
    """c_i / s_i of the rows divided by s_i, without what all of them share."""
    used = [k for k, c in enumerate(row) if c]
    inverse: list[Terms] = [{tuple((a, -e) for a, e in scales[k]): Fraction(1)} for k in used]
    shared = common_monomial({m: Fraction(1) for terms in inverse for m in terms})
    found = {}
    for k, terms in zip(used, inverse, strict=True):
        ((monomial, _),) = divided(terms, shared).items()
        factors = (power(symbol(str(monomials.symbol(a))), number(e)) for a, e in monomial)
        found[names[rows[k]]] = mul(number(row[k]), *factors)
    return found


def _by_numbers(rates: Sequence[Expression], draws: _Draws, names: Sequence[str], known: Sequence[Law]) -> list[Law]:
    """Laws with rational coefficients that hold at all random states and parameters, beside those that are known."""
    space = _null_space(rates, draws, varied=True)
    if space is None or space.shape[1] <= sum(all(c.is_number for c in law.coefficients.values()) for law in known):
        return []
    found: list[Law] = []
    plain = [law for law in known if all(c.is_number for c in law.coefficients.values())]
    vectors = [[float(sample([law.coefficients[n]], {})[0]) if n in law.coefficients else 0.0 for n in names]
               for law in plain]  # fmt: skip
    for row in _rational_rows(space):
        law = Law({n: number(c) for n, c in zip(names, row, strict=True) if c})
        error = _error(rates, draws, row)
        more = [*vectors, [float(c) for c in row]]
        if error <= AGREES and np.linalg.matrix_rank(np.array(more), tol=1e-9) == len(more):
            vectors = more
            found.append(Law(law.coefficients, max(error, np.finfo(float).eps)))
    return found


def _rational_rows(space: Array) -> list[Row]:
    """Echelon form of the columns, where all of its entries are simple fractions."""
    rows = echelon(space.T, relative=True)
    simple = fractions(rows, LARGEST_WHOLE)
    return [
        whole for whole, row in zip(simple, rows, strict=True)
        if np.allclose([float(a) for a in whole], row, rtol=1e-7, atol=1e-7)
    ]  # fmt: skip


def _error(rates: Sequence[Expression], draws: _Draws, row: Row) -> float:
    """Largest |c . f| of the largest |c_i f_i| at random points; infinite where there are too few.

    Points near the start may all lie on one side of a surface at which the equations change their formula. Where they
    are piecewise, the law is asked for at points of either sign and all sizes as well, as far as f has values there.
    """
    parts = [mul(number(c), f) for c, f in zip(row, rates, strict=True) if c]
    table = _values(parts, draws, CHECKS, varied=True)
    if table is None:
        return float("inf")
    if any(node.op in PIECEWISE for node in postorder(rates)):
        table = np.vstack([table, _relative(parts, draws.points(CHECKS, varied=True, anywhere=True), CHECKS)])
    return float(np.abs(table.sum(axis=1)).max())


def total_of(law: Law, values: Mapping[str, Expression]) -> Expression:
    """The conserved quantity where the states have these values."""
    return add(*(mul(c, values[name]) for name, c in law.coefficients.items()))
