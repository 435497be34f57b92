"""Branches that come to solutions which are not isolated."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq, minimize_scalar

import contin
from contin.bvp.from_guess import boundary_guess
from contin.model.model import Model

LENGTH = 5.0


def nucleation(centre: float, field: float) -> float:
    """Lowest eigenvalue of -f'' + h^2 (x - x0)^2 f, f' = 0 at 0 and 5, by Galerkin's method in cosines."""
    k = np.arange(40)
    x, w = np.polynomial.legendre.leggauss(120)
    x, w = 0.5 * LENGTH * (x + 1.0), 0.5 * LENGTH * w
    modes = np.cos(np.outer(k, np.pi * x / LENGTH))
    mass = (modes * w) @ modes.T
    stiff = np.diag((np.pi * k / LENGTH) ** 2 * np.diag(mass)) + field**2 * (modes * w * (x - centre) ** 2) @ modes.T
    return float(eigh(stiff, mass, subset_by_index=(0, 0))[0][0])


def slab(f, a, b, h):
    return Model(
        "slab", kind="bvp", time={"name": "x", "from": 0, "to": LENGTH}, states={"f": f, "g": 0, "A": a, "B": b},
        equations={"f": "g", "g": "f*(f^2 + A^2 - 1)", "A": "B", "B": "f^2*A"}, parameters={"h": h},
        conditions=["g(start) = 0", "g(end) = 0", "B(start) = h", "B(end) = h"],
    )  # fmt: skip


@pytest.mark.seldom
def test_a_superconducting_surface_ends_where_the_normal_states_begin():
    """f = 0, A = h (x - x0) at any x0: the branch ends where the lowest eigenvalue, least in x0, is 1."""
    def least(h):
        return minimize_scalar(lambda c: nucleation(c, h), bounds=(0.3, 1.2), method="bounded").fun - 1.0

    model = slab(0, 0, 0, 1.6)
    guess = {"f": "0.25*exp(-0.8*(x - 0.4)^2)", "g": "0", "A": "1.6*(x - 0.6)", "B": "1.6"}
    branch = contin.continuation(boundary_guess(model, guess), "h", (1.6, 2.0), direction="up")
    end = branch.ends[1]
    assert end.reason == "joined"
    assert "where A can be moved with h fixed" in end.text
    assert end.data["at"] == pytest.approx(brentq(least, 1.6, 1.8), rel=1e-6)
    assert np.abs(branch.columns["f.max"][-1]) < 1e-3


def test_two_modes_at_once_are_one_label_and_no_continuum():
    """u'' + lam u = u (u^2 + w^2/2), and the same for w: no test changes its sign where both vanish."""
    ends = [f"{name}({end}) = 0" for name in "uw" for end in ("start", "end")]
    model = Model(
        "pair", kind="bvp", states=dict.fromkeys("uvwz", 0), parameters={"lam": 8.0}, conditions=ends,
        equations={"u": "v", "v": "-lam*u + u^3 + w^2*u/2", "w": "z", "z": "-lam*w + w^3 + u^2*w/2"},
    )  # fmt: skip
    branch = contin.continuation(boundary_guess(model), "lam", (8.0, 12.0))
    (point,) = branch.points
    assert point.type == "BP"
    assert point.normal_form["kernel"] == 2
    assert abs(point.values["lam"] - np.pi**2) <= point.error < 1e-7
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    assert not any("several branches cross there" in note for note in branch.notes)
    assert len(point.switch()) == point.normal_form["branches"] - 1 == 4
