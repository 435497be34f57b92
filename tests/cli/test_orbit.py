"""`contin orbit`: an orbit of saved results in numbers, and as a table."""

import numpy as np
import pytest

import contin
from tests.cli.calls import call


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    model = contin.Model(
        "circle", states={"x": 0, "y": 0}, parameters={"mu": -1.0},
        equations={"x": "mu*x - 2*y - x*(x^2 + y^2)", "y": "2*x + mu*y - y*(x^2 + y^2)"},
    )  # fmt: skip
    diagram = contin.diagram(model, "mu", (-1, 1), values={"mu": [0.5]})
    path = tmp_path_factory.mktemp("orbit") / "a.contin"
    diagram.save(path)
    return path


def test_period_multipliers_and_samples_are_told(saved, capsys, tmp_path):
    assert call("orbit", saved, "start/HB1.UZ1", "--csv", tmp_path / "o.csv") == 0
    said = capsys.readouterr().out
    assert f"period {np.pi:.10g}" in said
    assert f"multipliers  1, {np.exp(-np.pi):.6g}" in said
    table = np.genfromtxt(tmp_path / "o.csv", delimiter=",", names=True)
    np.testing.assert_allclose(np.hypot(table["x"], table["y"]), np.sqrt(0.5), rtol=1e-8)
    assert call("orbit", saved, "start/HB1.UZ1", "--csv", "-") == 0
    assert capsys.readouterr().out == (tmp_path / "o.csv").read_text()


@pytest.mark.parametrize(
    ("place", "said"),
    [("start/HB1.UZ9", "its points: UZ1"), ("start/HB2.UZ1", "did you mean"), ("start", "BRANCH.LABEL")],
)
def test_what_is_not_there_is_said(saved, capsys, place, said):
    assert call("orbit", saved, place) == 2
    assert said in capsys.readouterr().err


def test_results_are_not_overwritten(saved, capsys):
    before = saved.read_bytes()
    assert call("orbit", saved, "start/HB1.UZ1", "--csv", saved) == 2
    assert saved.read_bytes() == before
