"""Boundary-value problems: where their branches start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from contin.abi import Array
from contin.bvp.from_guess import BoundaryGuess, boundary_guess
from contin.model.kinds import need_model
from contin.model.model import Model


def boundary_problem(
    model: Model,
    start: str | Mapping[str, object] | None = None,
    parameters: Mapping[str, object] | None = None,
    *,
    free: Sequence[str] = (),
    samples: tuple[Array, Array] | None = None,
) -> BoundaryGuess:
    """The start of a branch of solutions of a model of kind bvp, u' = f(t, u, p) with conditions.

    start : a named start, or a mapping of states to numbers or formulas in the independent variable: a guess, from
        which Newton's method finds the solution when the continuation begins.
    free : parameters that are solved for beside the one that varies, as many as there are more conditions than states.
    samples : instead of a start, points (K,) of the interval and the states there, (K, n).

    `continuation(boundary_problem(model), "p", (lo, hi))` labels LP and BP (normal forms `a`; `kind`, `a02`, `b11`,
    `b20`, `b30` of the reduced equation) and, where asked for, UZ and EX.
    """
    need_model(model)
    return boundary_guess(model, start, parameters, free, samples)
