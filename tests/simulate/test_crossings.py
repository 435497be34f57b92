"""Poincare sections against closed forms, from Python, by the command and from run files."""

import csv
import json

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model
from tests.cli.calls import call, results

# r' = r (1 - r^2), angle' = 1: the return map of the half line y = 0, x > 0 takes r^2/(1 - r^2) times exp(4 pi)
CYCLE = Model(
    "cycle", states={"x": 0.01, "y": 0}, parameters={"m": 1}, observables={"r": "sqrt(x^2 + y^2)"},
    equations={"x": "x*(m - x^2 - y^2) - y", "y": "x + y*(m - x^2 - y^2)"},
)  # fmt: skip


@pytest.mark.parametrize(("direction", "first", "apart"), [("up", 2.0, 2.0), ("down", 1.0, 2.0), ("both", 1.0, 1.0)])
def test_a_section_of_a_spiral_is_its_return_map(direction, first, apart):
    found = contin.simulate(CYCLE, time=6.5 * np.pi, section={"when": "y", "direction": direction}).section
    expected = np.arange(first, 6.5, apart) * np.pi
    np.testing.assert_allclose(found["t"], expected, rtol=1e-9)
    growth = 1e-4 / (1.0 - 1e-4) * np.exp(2.0 * expected)
    np.testing.assert_allclose(found["r"], np.sqrt(growth / (1.0 + growth)), rtol=1e-7)
    np.testing.assert_allclose(found["y"], 0.0, atol=1e-11)


def test_a_stroboscopic_section_is_taken_once_a_period_and_after_the_transient():
    """x' = -x + cos(2 pi t): once a period the distance from the response falls by exp(-1)."""
    model = Model("forced", states={"x": 3}, parameters={"c": 1}, equations={"x": "-c*x + cos(2*pi*t)"})
    found = contin.simulate(model, time=4.0, transient=2.5, section="sin(2*pi*t)").section
    np.testing.assert_allclose(found["t"], [3.0, 4.0, 5.0, 6.0], rtol=1e-10)
    response = 1.0 / (1.0 + 4.0 * np.pi**2)
    np.testing.assert_allclose(found["x"] - response, (3.0 - response) * np.exp(-found["t"]), rtol=1e-5)


def test_a_section_stands_beside_events_and_counts_no_jump_over_it():
    model = Model(
        "fire", states={"v": 0}, parameters={"I": 1.5}, equations={"v": "I - v"},
        events=[{"when": "v - 1", "direction": "up", "set": {"v": 0}}],
    )  # fmt: skip
    found = contin.simulate(model, time=5.0, section={"when": "v = 0.5", "direction": "both"})
    period = np.log(3.0)
    assert len(found.jumps) == 4
    np.testing.assert_allclose(found.section["t"], np.log(1.5) + period * np.arange(5), rtol=1e-8)
    np.testing.assert_allclose(found.section["v"], 0.5, rtol=1e-9)
    assert "5 crossings of the section" in str(found)


def test_mistakes_are_told():
    for section, words in (
        ("m", "never crossed"), ("x < 1", "condition|expression"), ({"at": "x"}, "expected an expression"),
        ({"when": "x", "direction": "left"}, "up, down or both"), ("mod(t, 1) - 0.5", "jump over zero"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            contin.simulate(CYCLE, section=section)
    with pytest.raises(InputError, match="belong to flows"):
        contin.simulate(Model("m", states={"x": 0.1}, kind="map", equations={"x": "x/2"}), section="x")


def test_the_command_and_run_files_write_the_section(tmp_path):
    model, table, out = tmp_path / "cycle.yaml", tmp_path / "section.csv", tmp_path / "out.json"
    model.write_text(CYCLE.text())
    picture = tmp_path / "section.png"
    words = ("--time", "20", "--section", "y = 0", "--csv", table, "--json", out, "--plot", picture, "-q")
    assert call("simulate", model, *words) == 0
    rows = list(csv.DictReader(table.open()))
    np.testing.assert_allclose([float(r["t"]) for r in rows], 2.0 * np.pi * np.arange(1, 4), rtol=1e-9)
    assert json.loads(out.read_text())["section"]["t"] == [float(r["t"]) for r in rows]
    assert picture.stat().st_size > 1000
    run = tmp_path / "run.yaml"
    run.write_text(
        "contin: 1\nmodel: cycle.yaml\nsimulate:\n"
        "  - {name: a, time: 20, section: {when: y, direction: down}, csv: a.csv}\n"
    )
    assert call("run", run, "--json", out, "-q") == 0
    [entry] = results(out)["simulations"]
    np.testing.assert_allclose(entry["section"]["t"], np.pi * np.arange(1, 7, 2), rtol=1e-9)
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 4
    run.write_text("contin: 1\nmodel: cycle.yaml\nsimulate: [{name: a, section: m}]\n")
    assert call("run", run, "-q") == 2
