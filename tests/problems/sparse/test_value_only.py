"""Partial differential equations as a value alone: zeros of the Jacobian are found, and the labels with it."""

import numpy as np
import pytest

import contin


def brusselator(cells: int) -> tuple[contin.FunctionProblem, list[int]]:
    """On an interval of length L with its rest at both ends; and how often it was called."""
    A, B, h, calls = 2.0, 5.45, 1.0 / (cells + 1), [0]

    def residual(u, p):
        calls[0] += 1
        x, y = u[:cells], u[cells:]
        diffused = [
            (np.append(w[1:], end) - 2 * w + np.append(end, w[:-1])) / (h * p["L"]) ** 2
            for w, end in ((x, A), (y, B / A))
        ]
        return np.append(0.008 * diffused[0] + A - (B + 1) * x + x * x * y, 0.004 * diffused[1] + B * x - x * x * y)

    rest = np.append(np.full(cells, A), np.full(cells, B / A))
    return contin.FunctionProblem(residual, rest, {"L": 0.3}), calls


@pytest.mark.parametrize("cells", [12, pytest.param(50, marks=pytest.mark.long), 240])
@pytest.mark.seldom
def test_hopf_points_are_where_the_differences_have_them(cells):
    problem, calls = brusselator(cells)
    line = contin.continuation(problem, "L", (0.3, 1.2))
    # trace of the mode k: B - 1 - A^2 = (Dx + Dy) m_k / L^2, m_k = (2 (N + 1) sin(k pi / 2 (N + 1)))^2
    modes = 2 * (cells + 1) * np.sin(np.pi * np.arange(1, 3) / (2 * (cells + 1)))
    exact = modes * np.sqrt(0.012 / 0.45)
    assert [p.type for p in line.points] == ["HB", "HB"]
    for point, place in zip(line.points, exact, strict=True):
        assert abs(point.values["L"] - place) <= point.error < 1e-8
    assert calls[0] < 20_000 + 8 * cells
    assert line.steps < 40
    assert not line.notes
