"""`contin.read` gives back whatever contin writes, as it was."""

import json

import numpy as np
import pytest

import contin
from contin.cli.export import export_file
from contin.errors import InputError
from contin.plot.write import picture
from contin.store.results import read_results
from tests.cli.calls import call


@pytest.fixture(scope="module")
def diagram():
    """A Hopf point at mu = 0, and its circles r = sqrt(mu) of period 2 pi."""
    model = contin.Model(
        "hopf", states={"x": 0.0, "y": 0.0}, parameters={"mu": -1.0}, observables={"r2": "x^2 + y^2"},
        equations={"x": "mu*x - y - x*(x^2 + y^2)", "y": "x + mu*y - y*(x^2 + y^2)"},
    )  # fmt: skip
    return contin.diagram(model, "mu", (-1.0, 1.0))


@pytest.fixture(scope="module")
def regions():
    """x' = a + b x - x^3: two folds 27 a^2 = 4 b^3 meet in a cusp; one equilibrium outside, three between."""
    model = contin.Model(
        "cusp", states={"x": -1.5}, parameters={"a": -1.0, "b": 1.0}, equations={"x": "a + b*x - x^3"}
    )
    return contin.phase(model, ("a", "b"), {"a": (-1, 1), "b": (-1, 1)})


@pytest.mark.parametrize("ending", ["contin", "json"])
def test_a_diagram_is_a_diagram_again(diagram, ending, tmp_path):
    diagram.save(tmp_path / f"d.{ending}")
    again = contin.read(tmp_path / f"d.{ending}")
    assert isinstance(again, type(diagram))
    assert (str(again), again.parameter, again.bounds, again.notes) == (
        str(diagram), "mu", (-1.0, 1.0), diagram.notes
    )  # fmt: skip
    assert len(again.graph.edges) == len(diagram.graph.edges)
    assert sorted(kind for _, kind in again.graph.nodes(data="type")) == sorted(
        kind for _, kind in diagram.graph.nodes(data="type")
    )
    for branch in diagram:
        np.testing.assert_array_equal(again[branch.name].eigenvalues, branch.eigenvalues)
        assert again[branch.name].start_row == branch.start_row
    assert "HB1" in again._repr_html_()
    with pytest.raises(InputError, match=r"contin.continuation\(diagram\['start'\]\['HB1'\].switch\(\)"):
        again.follow("start", "HB1")
    with pytest.raises(InputError, match="not extended"):
        again.extend("start")


def test_a_file_keeps_orbits_between_labels_with_all_digits(diagram, tmp_path):
    diagram.save(tmp_path / "d.contin")
    cycles = contin.read(tmp_path / "d.contin")["start/HB1"]
    live = diagram["start/HB1"]
    assert len(cycles.kept) >= min(len(live), 16) - 2
    for row in cycles.kept:
        np.testing.assert_array_equal(cycles.orbit(row).columns["x"], live.orbit(row).columns["x"])
        np.testing.assert_array_equal(cycles.orbit(row).multipliers, live.orbit(row).multipliers)
        radius = np.hypot(cycles.orbit(row).columns["x"], cycles.orbit(row).columns["y"])
        np.testing.assert_allclose(radius**2, cycles.columns["mu"][row], atol=1e-7)
    missing = next(row for row in range(len(live)) if row not in cycles.kept)
    with pytest.raises(InputError, match="keeps orbits at the rows"):
        cycles.orbit(missing)
    with pytest.raises(InputError, match="no periodic orbit"):
        contin.read(tmp_path / "d.contin")["start"].orbit(0)


@pytest.mark.parametrize("ending", ["contin", "json"])
def test_a_page_from_a_file_is_the_live_page(diagram, ending, tmp_path):
    diagram.save(tmp_path / f"d.{ending}")
    diagram.to_html(tmp_path / "live.html")
    contin.read(tmp_path / f"d.{ending}").to_html(tmp_path / "read.html")
    assert (tmp_path / "read.html").read_text() == (tmp_path / "live.html").read_text()
    page = picture(read_results(tmp_path / f"d.{ending}"), ".html").decode()
    live = (tmp_path / "live.html").read_text()
    assert page.count('"orbits":[{"row"') == live.count('"orbits":[{"row"') > 0
    assert page.split('"orbits":[{', 1)[1].split("]}}]")[0] == live.split('"orbits":[{', 1)[1].split("]}}]")[0]


def test_what_was_read_is_saved_and_followed_again(diagram, tmp_path):
    diagram.save(tmp_path / "a.contin")
    contin.read(tmp_path / "a.contin").save(tmp_path / "b.contin")
    again = contin.read(tmp_path / "b.contin")
    assert str(again) == str(diagram)
    cycles = contin.continuation(again["start"]["HB1"].switch(), "mu", (-1.0, 1.0))
    np.testing.assert_array_equal(cycles.columns["period"], diagram["start/HB1"].columns["period"])


@pytest.mark.seldom
def test_a_phase_diagram_is_one_again(regions, tmp_path):
    regions.save(tmp_path / "p.contin")
    again = contin.read(tmp_path / "p.contin")
    assert isinstance(again, type(regions))
    assert str(again) == str(regions)
    assert again.as_data() == regions.as_data()
    assert again.region_at({"a": 0.0, "b": 0.9}).total == 3
    assert again.region_at({"a": 0.9, "b": 0.0}).total == 1
    assert sorted(again.graph.edges) == sorted(regions.graph.edges)
    assert len(again.plot().axes) == len(regions.plot().axes)
    assert [branch.name for branch in again.loci] == [branch.name for branch in regions.loci]
    assert again[again.loci[0].name].locus == "LP"


@pytest.mark.seldom
def test_a_run_of_everything_has_everything(tmp_path):
    (tmp_path / "r.yaml").write_text(
        """contin: 1
model: {name: bead, states: {u: 1, v: 0}, parameters: {k: 1}, equations: {u: v, v: -u - k*v}}
diagram: {parameter: k, range: [0.5, 2]}
simulate: [{name: swing, time: 3, section: v = 0}]
sweep: {parameter: k, range: [1, 2], steps: 2}
outputs: {save: r.contin, json: r.json}
"""
    )
    assert call("run", tmp_path / "r.yaml", "--quiet") == 0
    for name in ("r.contin", "r.json"):
        found = contin.read(tmp_path / name)
        assert found.diagram.parameter == "k"
        assert [branch.name for branch in found] == [branch.name for branch in found.diagram]
        swing = found.simulations["swing"]
        assert (swing.t[-1], swing.complete) == (3.0, True)
        assert found.sweep.columns["k"].tolist() == [1.0, 1.5, 2.0, 2.0, 1.5, 1.0]
        assert swing.plot().axes
        assert found.sweep.plot(title="t").axes
        assert "swing of bead" in found._repr_html_()
    assert call("plot", tmp_path / "r.json", "--out", tmp_path / "r.svg", "--title", "Sweep and branches") == 0
    assert "sweep up: max" in (tmp_path / "r.svg").read_text()


JUMPY = """{contin: 1, name: saw, states: {v: 0}, equations: {v: 1},
 events: [{when: v - 1, direction: up, set: {v: v - 1}}]}"""


def test_a_trajectory_with_jumps_is_drawn_as_it_was(tmp_path):
    (tmp_path / "m.yaml").write_text(JUMPY)
    call("simulate", tmp_path / "m.yaml", "--time", "3.5", "--samples", "8", "--json", tmp_path / "s.json", "--quiet")
    found = contin.read(tmp_path / "s.json")
    live = contin.simulate(contin.load(tmp_path / "m.yaml"), time=3.5, samples=8)
    for name, column in live.columns.items():
        np.testing.assert_array_equal(found.columns[name], column)
    for name, column in live.drawn.items():
        np.testing.assert_array_equal(found._with_jumps()[name], column)
    assert (found.outcome, found.end_time) == ("done", 3.5)
    assert "saw" in str(found)


@pytest.mark.seldom
def test_sweeps_surveys_and_scans_of_commands_come_back(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call("sweep", "brusselator", "B", "0.5", "1", "--steps", "2", "--json", "w.json", "--quiet") == 0
    found = contin.read("w.json")
    live = contin.sweep(contin.load("brusselator"), "B", (0.5, 1.0), steps=2)
    assert (found.parameter, found.names, found.outcomes) == (live.parameter, live.names, live.outcomes)
    np.testing.assert_array_equal(found.statistics, live.statistics)
    assert call("survey", "brusselator", "--set", "B=1.5", "--processes", "1", "--json", "v.json", "--quiet") == 0
    survey = contin.read("v.json")
    assert dict(zip(survey.columns["parameter"], survey.columns["above.type"], strict=True))["B"] == "HB"
    assert "HB at 2" in str(survey)
    for name, heading in (("w", "B,direction"), ("v", "attractor,parameter")):
        assert call("plot", f"{name}.json", "--out", f"{name}.svg", "--title", "Drawn again") == 0
        assert "Drawn again" in (tmp_path / f"{name}.svg").read_text()
        assert export_file(tmp_path / f"{name}.json", tmp_path / f"{name}.csv") == 0
        assert (tmp_path / f"{name}.csv").read_text().startswith(heading)
        assert call("check", f"{name}.json") == 0


ENDED = {"contin": 1, "model": "m", "outcome": "done", "why": "", "end_time": 1}


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({**ENDED, "columns": {"x": [1]}}, "has no 't'"),
        ({**ENDED, "columns": {"t": [1, 2], "x": [1]}}, "lengths"),
        ({"contin": 1, "model": "m", "sweep": "k", "columns": {"direction": [1], "outcome": ["settled"]}}, "has no"),
        ({"contin": 1, "model": "m", "sweep": "k", "columns": []}, "should be object"),
        ({"contin": 9, "model": "m", "sweep": "k", "columns": {}}, "format 9"),
        ({"contin": 1, "model": "m", "survey": {}, "columns": {}}, "has no 'factor'"),
    ],
)  # fmt: skip
def test_what_is_damaged_is_refused_in_words(document, message, tmp_path):
    (tmp_path / "x.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=message):
        contin.read(tmp_path / "x.json")


def test_rows_that_do_not_fit_are_refused(diagram, tmp_path):
    diagram.save(tmp_path / "d.json")
    document = json.loads((tmp_path / "d.json").read_text())
    document["branches"][0]["rows"]["eigenvalues"].pop()
    (tmp_path / "d.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match="list of equal length"):
        contin.read(tmp_path / "d.json")


@pytest.mark.seldom
def test_phase_planes_come_back(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "q.yaml").write_text(
        "{contin: 1, name: well, states: {q: {value: 0.5, unit: m}, v: 0}, parameters: {d: 0.2}, "
        "equations: {q: v, v: q - q^3 - d*v}}"
    )
    box = ["--x", "-2", "2", "--y", "-1", "1"]
    assert call("plane", "q.yaml", "q", "v", *box, "--from", "1,0.5", "--json", "p.json", "-o", "p.svg", "--quiet") == 0
    again, live = contin.read("p.json"), contin.plane(
        contin.load("q.yaml"), "q", "v", x_range=(-2, 2), y_range=(-1, 1), points=[(1, 0.5)]
    )
    assert str(again) == str(live)
    assert again.document() == live.document()
    for one, other in zip(again.plot().axes, live.plot().axes, strict=True):
        assert (one.get_xlabel(), len(one.lines), one.get_xlim()) == (
            other.get_xlabel(), len(other.lines), other.get_xlim()
        )  # fmt: skip
    assert call("plot", "p.json", "--out", "p2.svg", "--title", "Two wells") == 0
    assert "Two wells" in (tmp_path / "p2.svg").read_text()
    assert call("check", "p.json") == 0
    document = json.loads((tmp_path / "p.json").read_text())
    document["equilibria"][0]["stability"] = "odd"
    (tmp_path / "p.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match="should be one of stable"):
        contin.read("p.json")
