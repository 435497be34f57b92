"""Coupled cells u' = (a - 1.2) u - q u^3 + W u branch from rest where a = 1.2 - an eigenvalue of the symmetric W.

Whatever solves with the Jacobian: dense or sparse factors, or factors of earlier points.
"""

import numpy as np
import pytest
import scipy.sparse as sp

import contin

N = 10


def cells(way):
    generator = np.random.default_rng(3)
    coupling = sp.random(N, N, density=0.2, random_state=3)
    coupling = (coupling + coupling.T) * 0.3
    q = generator.uniform(0.2, 1.0, N)

    def jacobian(u, p):
        return (sp.diags(p["a"] - 1.2 - 3.0 * q * u**2) + coupling).tocsc()

    problem = contin.FunctionProblem(
        lambda u, p: (p["a"] - 1.2) * u - q * u**3 + coupling @ u, np.zeros(N), {"a": -1.0},
        (lambda u, p: jacobian(u, p).toarray()) if way == "dense" else jacobian,
    )  # fmt: skip
    return problem, np.sort(1.2 - np.linalg.eigvalsh(coupling.toarray()))


@pytest.mark.parametrize("way", ["dense", "sparse", "earlier factors"])
@pytest.mark.seldom
def test_every_branch_from_rest_is_found_at_its_place(way, monkeypatch):
    if way == "earlier factors":
        monkeypatch.setattr("contin.problems.sparse.jacobian.ALWAYS_FACTORED", 0)
        monkeypatch.setattr("contin.linalg.factor.Factoriser.is_band_for", lambda self, matrix: False)
    monkeypatch.setattr("contin.linalg.copies.SMALL", 4)
    monkeypatch.setattr("contin.problems.sparse.large_equations.SMALL", 4)
    problem, places = cells(way)
    if way == "dense":  # other tests, mostly: the first five of ten
        places = places[:5]
    last = 2.5 if len(places) == N else float(places[-1]) + 0.01
    line = contin.continuation(problem, "a", (-1.0, last), settings={"steps": 400})
    assert line.notes == ()
    assert [p.type for p in line.points] == ["BP"] * len(places)
    for point, place in zip(line.points, places, strict=True):
        assert abs(point.values["a"] - place) <= point.error + 1e-14
        assert point.normal_form["kind"] == "pitchfork"
        assert point.normal_form["criticality"] == "supercritical"
    assert line.columns["unstable"][-1] == len(places)
