"""Results that were read back are those that were saved."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from tests.cli.calls import call


@pytest.fixture(scope="module")
def diagram():
    """x' = mu x - y - x (r^2 - 1)^2 + x, ...: r' = r (mu + 2 r^2 - r^4): a Bautin family with its fold at mu = -1."""
    radial = "mu + 2*(x^2 + y^2) - (x^2 + y^2)^2"
    model = contin.Model(
        "bautin", states={"x": 0.0, "y": 0.0}, parameters={"mu": -2.0},
        equations={"x": f"x*({radial}) - y", "y": f"x + y*({radial})"},
    )  # fmt: skip
    return contin.diagram(model, "mu", (-2.0, 1.0))


@pytest.mark.parametrize("ending", ["contin", "json"])
def test_branches_points_and_orbits_come_back_as_they_were(diagram, ending, tmp_path):
    path = tmp_path / f"bautin.{ending}"
    diagram.save(path)
    found = contin.read(path)
    assert [branch.name for branch in found] == [branch.name for branch in diagram]
    for branch in diagram:
        again = found[branch.name]
        assert (len(again), again.ends[0].reason, again.parent is None) == (
            len(branch), branch.ends[0].reason, branch.parent is None
        )  # fmt: skip
        for name, column in branch.columns.items():
            np.testing.assert_array_equal(again.columns[name], column)
            assert again.columns[name].dtype.kind == np.asarray(column).dtype.kind
        for point in branch.points:
            np.testing.assert_array_equal(again[point.label].eigenvalues, point.eigenvalues)
            assert dict(again[point.label].values) == dict(point.values)
    fold = found["start/HB1"]["LPC1"]
    assert fold.values["mu"] == pytest.approx(-1.0, abs=1e-8)
    np.testing.assert_allclose(np.hypot(fold.orbit.columns["x"], fold.orbit.columns["y"]), 1.0, atol=1e-6)
    assert fold.orbit.period == pytest.approx(2 * np.pi, rel=1e-8)


def test_branches_are_followed_from_what_was_read(diagram, tmp_path):
    diagram.save(tmp_path / "a.contin")
    found = contin.read(tmp_path / "a.contin")
    again = contin.continuation(found["start"]["HB1"].switch(), "mu", (-2.0, 1.0))
    np.testing.assert_array_equal(again.columns["period"], diagram["start/HB1"].columns["period"])
    np.testing.assert_array_equal(again.orbit(3).columns["x"], diagram["start/HB1"].orbit(3).columns["x"])


def _not_kept(branch):
    return next(row for row in range(len(branch)) if row not in {*branch.kept, *(p.index for p in branch.points)})


def test_what_a_file_does_not_hold_is_said(diagram, tmp_path):
    diagram.save(tmp_path / "a.contin")
    diagram.save(tmp_path / "a.json")
    found = contin.read(tmp_path / "a.contin")
    with pytest.raises(InputError, match="holds numbers and no equations"):
        contin.read(tmp_path / "a.json")["start"]["HB1"].switch()
    with pytest.raises(InputError, match="read from a file"):
        found["start/HB1"].orbit(_not_kept(found["start/HB1"]))
    with pytest.raises(InputError, match="no orbit"):
        _ = found["start"]["HB1"].orbit
    with pytest.raises(KeyError, match="start/HB1"):
        found["nobody"]
    found.plot()


def test_a_scan_is_read_as_its_table(tmp_path):
    (tmp_path / "s.yaml").write_text(
        "{contin: 1, model: classics/van-der-pol, scan: {axes: {alpha: [0.5, 1], x: [0.5, 1]}}, "
        "outputs: {save: s.scan, json: s.json}}"
    )
    assert call("run", tmp_path / "s.yaml", "--quiet") == 0
    found = contin.read(tmp_path / "s.scan")
    assert found.columns["alpha"] == [0.5, 0.5, 1.0, 1.0]
    assert sum(found.counts.values()) == 4
    assert found.plot().axes
    assert contin.read(tmp_path / "s.json").columns == found.columns
    assert len(found) == 0
