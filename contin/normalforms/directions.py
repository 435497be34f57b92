"""Every branch of equilibria (or fixed points) through a branch point, whatever the dimension of its kernel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contin.normalforms.branching import Direction, branch_point, simple_directions
from contin.normalforms.jet import Jet, Real
from contin.normalforms.multiple import CONTINUUM, REPEATED, multiple_directions, require_countable, scaling_of
from contin.normalforms.reduction import Reduction, kernel_dimension, reduce
from contin.normalforms.result import NormalForm
from contin.normalforms.static import StateError


def branch_directions(
    jet: Jet,
    *,
    known: Real | None = None,
    kernel: int | None = None,
    state_error: StateError = None,
) -> list[Direction]:
    """Tangents and curvatures of all branches through a branch point, the known (or primary) one first.

    Parameters
    ----------
    jet : one active parameter; forms of order 1 to 3 are used.
    known : (n + 1,) tangent of the branch at hand, if there is one.
    kernel : dimension of the kernel of F_u (map: F_u - 1); by default counted from its singular values.
    state_error : estimated error of u0, a length or one for each state (decides whether a quadratic term is zero);
        by default 1e-10 of the jet's typical sizes.

    Returns
    -------
    list of `Direction`; z0 + s tangent + s^2 curvature, s of either sign, is on a branch up to O(s^3). For a
    pitchfork's side branch the curvature's last entry is p2 of dp = p2 s^2. Empty where no second branch is real.
    """
    require_countable(kernel or 1)
    r = reduce(jet, kernel)
    if r.k == 1:
        error = branch_point(jet, state_error=state_error, reduction=r).errors["b20"]
        return simple_directions(r, known=known, b20_error=error)
    found = multiple_directions(r, state_error=state_error)
    if not found:
        return []
    first = 0 if known is None else int(np.argmax([_cosine(d.tangent, known) for d in found]))
    ordered = [found[first], *found[:first], *found[first + 1 :]]
    return [replace(d, primary=i == 0) for i, d in enumerate(ordered)]


def any_branch_point(
    jet: Jet, *, kernel: int | None = None, state_error: StateError = None, reduction: Reduction | None = None
) -> NormalForm:
    """BP whatever its kernel: `branch_point` for dimension one, else {kernel, kind: multiple, scaling, branches}.

    `continua`: circles of solutions of the leading terms. `repeated`: their solutions that are not simple.
    Raises LargeKernelError.
   """
    k = kernel or (reduction.k if reduction else kernel_dimension(jet))
    require_countable(k)
    r = reduction or reduce(jet, k)
    if k == 1:
        return branch_point(jet, state_error=state_error, reduction=r)
    found = multiple_directions(r, state_error=state_error)
    continua = sum(d.note == CONTINUUM for d in found)
    coefficients: dict[str, object] = {
        "kind": "multiple",
        "kernel": k,
        "scaling": scaling_of(r, state_error),
        "branches": len(found),
        "a01": r.a01.tolist(),
        "quadratic": r.T2.tolist(),
        "cubic": r.T3[:, :k, :k, :k].tolist(),
    }
    if continua:
        coefficients["continua"] = continua
    repeated = sum(d.note == REPEATED for d in found)
    if repeated or not found:  # the leading terms do not tell all branches
        coefficients["repeated"] = max(repeated, 1)
    words = f"branch point with a {k}-dimensional kernel, {len(found)} branches"
    return NormalForm("BP", coefficients, words, {"Q": r.right, "P": r.left, "h": r.h})


def turning_branch_point(jet: Jet, kernel: int) -> NormalForm:
    """BP with a kernel that a continuous symmetry turns: circles of branches, which are not looked for.

    {kernel, kind: multiple, symmetry: rotation, a01, quadratic, cubic} as of `any_branch_point`; for a kernel of
    dimension 2 all that branches off is one circle.
    """
    r = reduce(jet, kernel)
    coefficients: dict[str, object] = {
        "kind": "multiple", "kernel": kernel, "symmetry": "rotation", "a01": r.a01.tolist(),
        "quadratic": r.T2.tolist(), "cubic": r.T3[:, :kernel, :kernel, :kernel].tolist(),
    }  # fmt: skip
    if kernel == 2:
        coefficients["branches"] = 2
    words = f"branch point with a {kernel}-dimensional kernel that the rotation turns"
    return NormalForm("BP", coefficients, words, {"Q": r.right, "P": r.left, "h": r.h})


def _cosine(a: Real, b: Real) -> float:
    return float(abs(a @ b) / (np.linalg.norm(a) * np.linalg.norm(b)))
