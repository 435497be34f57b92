"""Families of cycles in closed form, of functions and of `kind: pde`."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

import contin
from contin.linalg.csc import filled


def planted(a3, a5, exact=False):
    """r' = r (mu + (a3 + a) r^2 + a5 r^4) with angle t; on it hang a plane that turns by half an angle in a period,
    with multipliers -exp(T (-0.5 - a +- r)) and w^2 = r - 0.5 - a on the doubled orbit; one with
    exp(T (mu - 0.3 - a +- 0.4 i)); and s' = (mu - 0.4 - a) s - s^3."""

    def residual(z, p):
        x, y, w1, w2, v1, v2, s = z.tolist()
        mu, a, r2 = p["mu"], p["a"], x * x + y * y
        growth, pull = mu + (a3 + a) * r2 + a5 * r2 * r2, 0.5 + a + w1 * w1 + w2 * w2
        return np.array([
            growth * x - y, growth * y + x,
            -pull * w1 + x * w1 + y * w2 - 0.5 * w2, -pull * w2 + y * w1 - x * w2 + 0.5 * w1,
            (mu - 0.3 - a) * v1 - 0.4 * v2, (mu - 0.3 - a) * v2 + 0.4 * v1, (mu - 0.4 - a) * s - s**3,
        ])  # fmt: skip

    def jacobian(z, p):
        x, y, w1, w2, _, _, s = z.tolist()
        mu, a, r2 = p["mu"], p["a"], x * x + y * y
        growth, slope = mu + (a3 + a) * r2 + a5 * r2 * r2, 2 * (a3 + a) + 4 * a5 * r2
        pull, w12 = 0.5 + a + w1 * w1 + w2 * w2, 2 * w1 * w2
        full = np.array([
            [growth + slope * x * x, slope * x * y - 1, 0, 0, 0, 0, 0],
            [slope * x * y + 1, growth + slope * y * y, 0, 0, 0, 0, 0],
            [w1, w2, x - pull - 2 * w1 * w1, y - 0.5 - w12, 0, 0, 0],
            [-w2, w1, y + 0.5 - w12, -x - pull - 2 * w2 * w2, 0, 0, 0],
            [0, 0, 0, 0, mu - 0.3 - a, -0.4, 0], [0, 0, 0, 0, 0.4, mu - 0.3 - a, 0],
            [0, 0, 0, 0, 0, 0, mu - 0.4 - a - 3 * s * s],
        ])  # fmt: skip
        return filled(pattern, full.T[entries.T])

    pattern = np.zeros((7, 7))
    pattern[:2, :2] = pattern[2:4, :4] = pattern[4:6, 4:6] = pattern[6, 6] = 1
    names = ["x", "y", "w1", "w2", "v1", "v2", "s"]
    entries = pattern > 0
    pattern = sparse.csc_matrix(pattern)
    derivatives = {"jacobian": jacobian} if exact else {"sparsity": pattern}
    return contin.FunctionProblem(residual, np.zeros(7), {"mu": -0.5, "a": 0.0}, states=names, **derivatives)


def crossing():
    """A circle of radius 1/2 with s' = s (p^2 + q^2 - 1/4 - s), turning at a rate 1 + 3 s/10: on p^2 + q^2 = 1/4 the
    family s = p^2 + q^2 - 1/4 crosses s = 0, with another period."""

    def residual(z, k):
        x, y, s = z.tolist()
        growth, rate = 0.25 - x * x - y * y, 1.0 + 0.3 * s
        return np.array([growth * x - rate * y, growth * y + rate * x, s * (k["p"] ** 2 + k["q"] ** 2 - 0.25 - s)])

    def jacobian(z, k):
        x, y, s = z.tolist()
        growth, rate = 0.25 - x * x - y * y, 1.0 + 0.3 * s
        return sparse.csc_matrix([
            [growth - 2 * x * x, -rate - 2 * x * y, -0.3 * y], [rate - 2 * x * y, growth - 2 * y * y, 0.3 * x],
            [0.0, 0.0, k["p"] ** 2 + k["q"] ** 2 - 0.25 - 2 * s],
        ])  # fmt: skip

    return contin.FunctionProblem(residual, np.zeros(3), {"p": 0.3, "q": 0.4}, jacobian)


def family(problem, span, **settings):
    line = contin.continuation(problem, "mu", (-0.6, 0.2))
    hopf = next(p for p in line.points if p.type == "HB" and abs(p.values["mu"]) < 1e-6)
    return contin.continuation(hopf.switch(), "mu", span, settings={"intervals": 8, "step": 0.05, **settings})


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


@dataclass(frozen=True)
class GinzburgLandau:
    """A_t = lap A + (r + i nu) A - (c3 - i mu) |A|^2 A - c5 |A|^4 A on a rectangle 2 pi by pi, A = u + i v, zero on its
    edge: `nx` by `ny` nodes, as far apart as BifurcationKit's tutorial has them (2 pi/nx and pi/ny)."""

    nx: int
    ny: int
    mu: float = 0.1
    c3: float = -1.0
    c5: float = 1.0

    @property
    def laplacian(self):
        x, y = ((sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(m, m)) * (m / side) ** 2)
                for m, side in ((self.nx, 2 * np.pi), (self.ny, np.pi)))  # fmt: skip
        return sparse.csr_matrix(sparse.kron(sparse.eye(self.ny), x) + sparse.kron(y, sparse.eye(self.nx)))

    @property
    def hopf(self):
        """r where the zero state loses its stability: the smallest eigenvalue of -lap."""
        return sum((2 - 2 * np.cos(np.pi / (m + 1))) * (m / side) ** 2
                   for m, side in ((self.nx, 2 * np.pi), (self.ny, np.pi)))  # fmt: skip

    def model(self):
        """As a Python function with a sparse Jacobian; u and v of all nodes."""
        n, both = self.nx * self.ny, sparse.block_diag([self.laplacian] * 2).tocsr()

        def residual(z, p):
            a, b = z[:n], z[n:]
            s = a * a + b * b
            return both @ z + np.concatenate([
                p["r"] * a - b - s * (self.c3 * a - self.mu * b) - self.c5 * s * s * a,
                p["r"] * b + a - s * (self.c3 * b + self.mu * a) - self.c5 * s * s * b,
            ])  # fmt: skip

        def jacobian(z, p):
            a, b = z[:n], z[n:]
            s = a * a + b * b
            ga, gb = self.c3 * a - self.mu * b, self.c3 * b + self.mu * a
            own = p["r"] - self.c3 * s - self.c5 * s * s
            aa, ab = own - 2 * a * ga - 4 * self.c5 * s * a * a, self.mu * s - 1 - 2 * b * ga - 4 * self.c5 * s * a * b
            ba, bb = 1 - self.mu * s - 2 * a * gb - 4 * self.c5 * s * a * b, own - 2 * b * gb - 4 * self.c5 * s * b * b
            return (both + sparse.diags([np.concatenate([aa, bb]), ab, ba], [0, n, -n])).tocsc()

        return contin.FunctionProblem(
            residual, np.zeros(2 * n), {"r": 0.5}, jacobian, name="ginzburg-landau",
            record=lambda z, p: {"largest": np.abs(z).max()},
        )  # fmt: skip
