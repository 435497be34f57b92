"""Zero-Hopf points on an invariant plane: where Hopf and branch points meet, and w0 = 0 is invariant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Final

import numpy as np

from contin.normalforms.homological import CentreManifold
from contin.normalforms.jet import Jet
from contin.normalforms.result import NormalForm
from contin.normalforms.zero_hopf import REFLECTED, quadratic_errors, zero_hopf_manifold, zero_hopf_on

SMALL: Final = 1e-6  # of the products that cancel: a determinant below this has no sign


def zero_hopf_on_plane(
    jet: Jet, omega: float | None = None, off: Mapping[str, float] = MappingProxyType({})
) -> NormalForm:
    """ZH with p0 . F_p = 0 in both active parameters of the jet: the coefficients of `zero_hopf`, and the case.

    With R = |w1|^2 and w0 ~ R the amplitudes obey equations of Lotka and Volterra (Langford, SIAM J. Appl. Math. 37
    (1979) 22; Guckenheimer and Holmes, Nonlinear Oscillations, sec. 7.4),

        w0' = w0 (nu + b w0 + c R),  R' = 2 R (alpha + d w0 + e R)

    (key `amplitudes`), whose Hopf curves are alpha = 0 in the plane and b alpha = d nu off it. The trace at the cycles
    beside the plane vanishes, and a curve of tori begins, where b e (b e - c d) < 0. Where G200 and G110
    vanish too, a reflection w0 -> -w0 is broken instead. `off`: by how much coefficients are off as the point is.
    """
    manifold = zero_hopf_manifold(jet, omega)
    return zero_hopf_on_plane_of(manifold, quadratic_errors(manifold), off)


def zero_hopf_on_plane_of(
    manifold: CentreManifold, errors: Mapping[str, float], off: Mapping[str, float] = MappingProxyType({})
) -> NormalForm:
    """The same of a manifold in (w0, w1, conj w1) and both parameters, whose G200, G011 and G110 have these errors."""
    form = zero_hopf_on(manifold, errors)
    errors = {key: error + off.get(key, 0.0) for key, error in form.errors.items()}
    coefficients = {key: value for key, value in form.coefficients.items() if key not in ("s", "theta", "E")}
    if coefficients["case"] == REFLECTED:
        case = REFLECTED
    else:
        b, c, d, e = amplitudes = _amplitudes(manifold)
        coefficients["amplitudes"] = dict(zip("bcde", amplitudes, strict=True))
        first, second = b * e, c * d
        case = "Hopf-transcritical (invariant plane): "
        undecided = abs(coefficients["G200"]) <= errors["G200"] or abs(d) <= errors["G110"]
        if undecided or abs(first - second) <= SMALL * (abs(first) + abs(second)):
            case += "degenerate"
        else:
            case += "a torus branches off the cycles beside the plane" if first * (first - second) < 0.0 else "no torus"
    coefficients["case"] = case
    return replace(form, coefficients=coefficients, errors=errors, said=f"zero-Hopf point, {case}")


def _amplitudes(manifold: CentreManifold) -> tuple[float, ...]:
    """b, c, d, e with w0 = 0 on the plane itself.

    The coordinate of the centre manifold is w = w0 + gamma R, for the plane may be curved. It shows in a term
    gamma (2 alpha - nu) R of w', linear in the parameters.
    """
    g = manifold.g
    units = ((1, 0), (0, 1))
    b, c = g((2, 0, 0), 0).real, g((1, 1, 1), 0).real
    d, e = g((1, 1, 0), 1).real, g((0, 2, 1), 1).real
    slopes = np.array([2.0 * g((0, 1, 0, *u), 1).real - g((1, 0, 0, *u), 0).real for u in units])
    tilt = np.array([g((0, 1, 1, *u), 0).real for u in units])
    gamma = float(slopes @ tilt) / max(float(slopes @ slopes), 1e-300)
    return float(b), float(c + 2.0 * (b - d) * gamma), float(d), float(e + d * gamma)
