"""Families of cycles in closed form, of functions and of `kind: pde`."""

import numpy as np
from scipy import sparse

import contin


def planted(a3, a5, exact=False):
    """r' = r (mu + (a3 + a) r^2 + a5 r^4) with angle t; on it hang a plane that turns by half an angle in a period,
    with multipliers -exp(T (-0.5 - a +- r)); one with exp(T (mu - 0.3 - a +- 0.4 i)); and
    s' = (mu - 0.4 - a) s - s^3."""

    def residual(z, p):
        x, y, w1, w2, v1, v2, s = z
        mu, a, r2 = p["mu"], p["a"], x * x + y * y
        growth = mu + (a3 + a) * r2 + a5 * r2 * r2
        return np.array([
            growth * x - y, growth * y + x,
            -(0.5 + a) * w1 + x * w1 + y * w2 - 0.5 * w2, -(0.5 + a) * w2 + y * w1 - x * w2 + 0.5 * w1,
            (mu - 0.3 - a) * v1 - 0.4 * v2, (mu - 0.3 - a) * v2 + 0.4 * v1, (mu - 0.4 - a) * s - s**3,
        ])  # fmt: skip

    def jacobian(z, p):
        x, y, w1, w2, _, _, s = z
        mu, a, r2 = p["mu"], p["a"], x * x + y * y
        growth, slope = mu + (a3 + a) * r2 + a5 * r2 * r2, 2 * (a3 + a) + 4 * a5 * r2
        full = np.array([
            [growth + slope * x * x, slope * x * y - 1, 0, 0, 0, 0, 0],
            [slope * x * y + 1, growth + slope * y * y, 0, 0, 0, 0, 0],
            [w1, w2, x - 0.5 - a, y - 0.5, 0, 0, 0], [-w2, w1, y + 0.5, -x - 0.5 - a, 0, 0, 0],
            [0, 0, 0, 0, mu - 0.3 - a, -0.4, 0], [0, 0, 0, 0, 0.4, mu - 0.3 - a, 0],
            [0, 0, 0, 0, 0, 0, mu - 0.4 - a - 3 * s * s],
        ])  # fmt: skip
        return sparse.csc_matrix((full.T[filled.T], rows, starts), shape=(7, 7))

    pattern = np.zeros((7, 7))
    pattern[:2, :2] = pattern[2:4, :4] = pattern[4:6, 4:6] = pattern[6, 6] = 1
    names = ["x", "y", "w1", "w2", "v1", "v2", "s"]
    filled = pattern > 0
    filled[2:4, :4] = True
    pattern = sparse.csc_matrix(pattern)
    rows, starts = pattern.indices, pattern.indptr
    derivatives = {"jacobian": jacobian} if exact else {"sparsity": pattern}
    return contin.FunctionProblem(residual, np.zeros(7), {"mu": -0.5, "a": 0.0}, states=names, **derivatives)


def family(problem, span, **settings):
    line = contin.continuation(problem, "mu", (-0.6, 0.2))
    hopf = next(p for p in line.points if p.type == "HB" and abs(p.values["mu"]) < 1e-6)
    return contin.continuation(hopf.switch(), "mu", span, settings={"intervals": 8, **settings})


def landau(points, method):
    """A_t = (mu + i) A + (1 + i c1) A_xx - (1 + i c2) |A|^2 A on a circle, A = u + i v."""
    square = "(u^2 + v^2)"
    return contin.load({
        "name": "cgl", "kind": "pde",
        "domain": {"x": {"to": "2*pi", "points": points, "method": method, "periodic": True}},
        "fields": {"u": 0, "v": 0}, "parameters": {"mu": -0.2, "c1": 0.5, "c2": -0.8},
        "equations": {
            "u": f"mu*u - v + dxx(u) - c1*dxx(v) - {square}*(u - c2*v)",
            "v": f"mu*v + u + dxx(v) + c1*dxx(u) - {square}*(v + c2*u)",
        },
    })  # fmt: skip
