"""`start: auto`: each way on a system that only it can solve, and what is said of it."""

from __future__ import annotations

import json

import numpy as np
import pytest

import contin
from contin.errors import NoSolutionError
from contin.simulate.relax import relax
from tests.cli.calls import call
from tests.problems.follow import model

OREGONATOR = {"x": "s*(y - x*y + x - q*x^2)", "y": "(-y - x*y + z)/s", "z": "w*(x - z)"}


def oregonator():
    return model(OREGONATOR, {"x": 1.0, "y": 1.0, "z": 2.0}, {"q": 8.375e-6, "w": 0.161, "s": 77.27})


def test_a_state_at_rest_is_taken_as_it_is():
    found = contin.find_start(model({"x": "p - x^2"}, {"x": -1.0}, {"p": 1.0}))
    assert (found.how, found.solution.u) == ("given", pytest.approx([-1.0]))  # the unstable one, as given


def test_a_transient_leads_to_the_state_that_attracts_it_and_not_to_the_one_that_newton_finds():
    found = contin.find_start(model({"x": "p*x*(1 - x)*(x - 0.3)"}, {"x": 0.31}, {"p": 1.0}))
    assert (found.how, found.solution.u) == ("rest", pytest.approx([1.0], rel=1e-12))


def test_a_stiff_network_comes_to_rest_in_few_steps():
    """Robertson (1966): k1 a = 1e4 b c + 3e7 b^2 with all mass in c, after 1e11 time units."""
    rates = {"a": "-k*a + 1e4*b*c", "b": "k*a - 1e4*b*c - 3e7*b^2 + s*(1 - c)", "c": "3e7*b^2 - s*(1 - c)"}
    network = model(rates, {"a": 1.0, "b": 0.0, "c": 0.0}, {"k": 0.04, "s": 1e-3})
    found = contin.find_start(network)
    b, c = (dict(zip(found.system.state_names, found.solution.u, strict=True)).get(n) for n in ("b", "c"))
    assert found.how == "rest"
    if b is not None and c is not None:
        assert 3e7 * b * b == pytest.approx(1e-3 * (1 - c), rel=1e-8)


def test_a_trajectory_is_pushed_off_a_saddle_that_it_runs_into():
    found = contin.find_start(model({"x": "x*(p - x)", "y": "-y"}, {"x": 0.0, "y": 1.0}, {"p": 1.0}))
    assert found.solution.u == pytest.approx([1.0, 0.0], abs=1e-10)


def test_a_cycle_is_found_and_its_words_say_so():
    equations = {"x": "x - y - p*x*(x^2 + y^2)", "y": "x + y - p*y*(x^2 + y^2)"}
    found = contin.find_start(model(equations, {"x": 0.3, "y": 0.1}, {"p": 1.0}))
    assert (found.how, found.solution.period) == ("cycle", pytest.approx(2 * np.pi, rel=1e-9))
    assert "simulated to a cycle" in str(found)


def test_a_stiff_cycle_is_found():
    """The Oregonator's period is 302.8580 (Hairer and Wanner, Solving ODEs II, sec. IV.10)."""
    found = contin.find_start(oregonator())
    assert (found.how, found.solution.period) == ("cycle", pytest.approx(302.8580, abs=1e-3))


def test_where_only_equilibria_are_wanted_newton_goes_on_from_a_cycle():
    rest = contin.equilibrium(oregonator(), start="auto")
    x = rest.u[0]
    assert rest.u == pytest.approx([x, x / (1 + x), x], rel=1e-9)


def test_what_escapes_leaves_newton_and_a_false_solution_is_none():
    found = contin.find_start(model({"x": "x^2 - r"}, {"x": 2.0}, {"r": 1.0}))
    assert found.solution.u == pytest.approx([1.0], rel=1e-12)
    with pytest.raises(NoSolutionError, match=r"the trajectory escapes by t = .*deflated Newton .* finds none"):
        contin.find_start(model({"x": "x^2 + r"}, {"x": 2.0}, {"r": 1.0}))


@pytest.mark.parametrize("far", [1e3, 1e9, -1e15])
def test_newton_from_far_away_solves_in_the_solution_s_own_size(far):
    assert contin.equilibrium(model({"x": "x^2 - r"}, {"x": far}, {"r": 1.0})).u == pytest.approx(
        [np.sign(far)], rel=1e-13
    )
    with pytest.raises(NoSolutionError):
        contin.equilibrium(model({"x": "x^2 + r"}, {"x": far}, {"r": 1.0}))


@pytest.mark.parametrize(("r", "period"), [(2.8, 1), (3.2, 2), (3.5, 4)])
def test_maps_are_iterated_to_their_cycles(r, period):
    logistic = contin.Model(
        "logistic", kind="map", states={"x": 0.3}, parameters={"r": r}, equations={"x": "r*x*(1 - x)"}
    )
    found = contin.find_start(logistic)
    assert getattr(found.system, "times", 1) == period
    orbit = [float(found.solution.u[0])]
    for _ in range(period):
        orbit.append(r * orbit[-1] * (1 - orbit[-1]))
    assert orbit[-1] == pytest.approx(orbit[0], rel=1e-11)


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e9])
def test_rest_is_found_alike_in_any_units(unit):
    rates = {"x": f"p*{unit!r} - x", "y": "x*0.5 - 30*y"}
    system = contin.api.compiled(model(rates, {"x": 3 * unit, "y": 0.0}, {"p": 1.0}))
    end = relax(system, np.array([3 * unit, 0.0]), np.array([1.0]))
    assert end.outcome == "rest"
    assert end.stable
    assert end.u / unit == pytest.approx([1.0, 1 / 60], rel=1e-4)


def test_run_files_and_diagrams_start_by_themselves(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    written = {
        "contin": 1, "model": {"name": "cell", "states": {"x": 0.9, "y": 0.1}, "parameters": {"p": 1.0},
                               "equations": {"x": "p*y - x", "y": "x - p*y"}},
        "diagram": {"parameter": "p", "range": [0.5, 2], "start": "auto"},
        "continuations": [{"name": "line", "start": "auto", "parameter": "p", "range": [0.5, 2]}],
    }  # fmt: skip
    (tmp_path / "run.yaml").write_text(json.dumps(written))
    assert call("run", "run.yaml", "--json", "out.json") == 0
    document = json.loads((tmp_path / "out.json").read_text())
    assert [b["name"] for b in document["branches"]] == ["auto", "line"]
    assert any("line: start: simulated to rest" in note for note in document["notes"])
    assert any("start 'auto': simulated to rest" in note for note in document["notes"])


def test_a_total_that_zero_parameters_conserve_is_held_with_them():
    """Inflow and dilution are off: x + y is conserved then, and only then; k x = q y."""
    cell = model(
        {"x": "-k*x + q*y + d*(1 - x)", "y": "k*x - q*y - d*y", "z": "x - z + e"}, {"x": 3.0, "y": 1.0, "z": 0.0},
        {"k": 1.0, "q": 3.0, "d": 0.0, "e": 0.0},
    )  # fmt: skip
    found = contin.find_start(cell, start={"x": 2.0})
    assert "with d held at 0, which conserves total_x" in found.words
    values = dict(zip(found.system.state_names, found.solution.u, strict=True))
    assert values.get("y", 3.0 - values.get("x", 0.0)) == pytest.approx(0.75, rel=1e-9)
    assert "d" not in found.system.parameter_names
    survey = contin.survey(cell, processes=1)
    assert {row.parameter for row in survey.rows} == {"k", "q", "total_x"}
