"""The Brusselator with diffusion on an interval, by finite differences."""

import numpy as np
from scipy import sparse

from contin import FunctionProblem

POINTS = 24  # inner points


def model(points: int = POINTS) -> FunctionProblem:
    """u_t = Du/L^2 u_xx + A - (B + 1) u + u^2 v, v_t = Dv/L^2 v_xx + B u - u^2 v on (0, 1), u = A, v = B/A at the ends.

    The homogeneous state u = A, v = B/A solves the discrete equations too. Its perturbations sin(k pi x) are
    eigenvectors of the discrete Laplacian, with -m_k = -(2 - 2 cos(k pi h))/h^2: mode k oscillates where the trace
    B - 1 - A^2 - (Du + Dv) m_k/L^2 vanishes.
    """
    h = 1.0 / (points + 1)
    laplace = sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(points, points), format="csr") / h**2
    ends = np.zeros(points)
    ends[[0, -1]] = 1.0 / h**2

    def residual(z, p):
        u, v = z[:points], z[points:]
        du, dv = p["Du"] / p["L"] ** 2, p["Dv"] / p["L"] ** 2
        reaction = u * u * v
        return np.concatenate(
            [
                du * (laplace @ u + p["A"] * ends) + p["A"] - (p["B"] + 1) * u + reaction,
                dv * (laplace @ v + p["B"] / p["A"] * ends) + p["B"] * u - reaction,
            ]
        )

    def jacobian(z, p):
        u, v = z[:points], z[points:]
        du, dv = p["Du"] / p["L"] ** 2, p["Dv"] / p["L"] ** 2
        blocks = [
            [du * laplace + sparse.diags(2 * u * v - p["B"] - 1), sparse.diags(u * u)],
            [sparse.diags(p["B"] - 2 * u * v), dv * laplace - sparse.diags(u * u)],
        ]
        return sparse.bmat(blocks, format="csc")

    values = {"L": 0.4, "A": 2.0, "B": 5.45, "Du": 0.008, "Dv": 0.004}
    modes = np.arange(1, 4)
    m = (2 - 2 * np.cos(modes * np.pi * h)) / h**2
    lengths = np.sqrt((values["Du"] + values["Dv"]) * m / (values["B"] - 1 - values["A"] ** 2))
    return FunctionProblem(
        residual,
        np.concatenate([np.full(points, values["A"]), np.full(points, values["B"] / values["A"])]),
        values,
        jacobian,
        ranges={"L": (0.4, 1.7)},
        record=lambda z, p: {"middle": z[points // 2]},
        name="brusselator-1d",
        title="The Brusselator with diffusion on an interval, by finite differences",
        source="R. Lefever and I. Prigogine, J. Chem. Phys. 48 (1968) 263; AUTO-07p manual, demo bru",
        expect=[
            {
                "label": "HB",
                "at": [{"L": length} for length in lengths if length < 1.7],
                "run": {"parameter": "L", "range": [0.4, 1.7]},
            }
        ],
    )
