"""One run that cannot start costs no other: it is skipped with a note and exit code 1, whatever it was to start as."""

import json

import pytest

from tests.cli.calls import call, run_file

OSCILLATOR = {  # r' = r (p - r^2), theta' = 1: a Hopf point at p = 0, cycles of radius sqrt(p)
    "contin": 1,
    "name": "normal-form",
    "states": {"x": 0, "y": 0},
    "parameters": {"p": {"value": -1, "range": [-1, 1]}, "q": 1},
    "equations": {"x": "p*x - q*y - x*(x^2 + y^2)", "y": "q*x + p*y - y*(x^2 + y^2)"},
    "starts": {"nowhere": {"x": "sqrt(p)", "y": 0}},
}
WEAK = {  # averaged: r' = r (1 - r^2/4)/2
    "contin": 1,
    "name": "van-der-pol",
    "states": {"x": 2, "y": 0},
    "parameters": {"eps": 0.1, "p": {"value": 1, "range": [0, 2]}},
    "equations": {"x": "y", "y": "-x + eps*(p - x^2)*y"},
    "averaging": {"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    "starts": {"nowhere": {"x": "log(-p)", "y": 0}},
}
GOOD = {"name": "good", "parameter": "p"}
BOX = {"p": [-1, 1], "q": [0, 2]}
FAILING = {
    "orbit that decays": {"start": {"x": 0.1}, "as": "orbit", "parameter": "p"},
    "orbit, no value": {"start": "nowhere", "as": "orbit", "parameter": "p"},
    "equilibrium, no value": {"start": "nowhere", "as": "equilibrium", "parameter": "p"},
    "no value": {"start": "nowhere", "parameter": "p"},
    "connection": {"start": {"x": 0}, "as": "connection", "parameter": ["p", "q"], "range": BOX},
    "connection to": {"start": {"x": 0}, "to": {"x": 1}, "as": "connection", "parameter": ["p", "q"], "range": BOX},
    "outside": {"start": {"x": 0, "parameters": {"p": "q + 1"}}, "parameter": "p"},
    "label": {"from": "good.LP1", "parameter": "p"},
    "orbit from": {"from": "good.LP7", "as": "orbit", "parameter": "p"},
    "locus from": {"from": "good.BP1", "as": "locus", "parameter": ["p", "q"], "range": BOX},
    "samples": {"samples": "noise.csv", "parameter": "p"},
}


@pytest.mark.parametrize("what", FAILING)
@pytest.mark.parametrize("first", [True, False])
def test_a_run_that_cannot_start_is_skipped_and_the_others_are_written(tmp_path, what, first):
    lines = "".join(f"{t},{(-1) ** t * 1e3},{t % 3}\n" for t in range(12))
    (tmp_path / "noise.csv").write_text(f"t,x,y\n{lines}")
    failing = {"name": "failing", **FAILING[what]}
    needs_good = "from" in failing
    runs = [failing, GOOD] if first and not needs_good else [GOOD, failing, {**GOOD, "name": "last"}]
    file = run_file(tmp_path, OSCILLATOR, *runs, outputs={"json": "r.json", "save": "r.contin"})
    code = call("run", file, "-q")
    if code == 2:  # found before anything was computed
        assert not (tmp_path / "r.json").exists()
        assert call("check", file) == 2
        return
    assert code == 1
    document = json.loads((tmp_path / "r.json").read_text())
    expected = [run["name"] for run in runs if run is not failing]
    assert [branch["name"] for branch in document["branches"]] == expected
    assert any(note.startswith("failing skipped: ") for note in document["notes"])


TRANSFORMS = {
    "average": [{"average": {"form": "polar"}}],
    "average cartesian": [{"average": {"form": "cartesian"}}],
    "fix": [{"fix": {"parameters": {"eps": 0.1}}}],
    "none": [],
}


@pytest.mark.parametrize("transform", TRANSFORMS)
def test_of_a_transformed_model_too(tmp_path, transform):
    runs = [{"name": "failing", "start": "nowhere", "parameter": "p"}, GOOD]
    file = run_file(tmp_path, WEAK, *runs, transform=TRANSFORMS[transform], outputs={"json": "r.json"})
    code = call("run", file, "-q")
    if code == 2:
        assert call("check", file) == 2
        return
    assert code == 1
    document = json.loads((tmp_path / "r.json").read_text())
    assert [branch["name"] for branch in document["branches"]] == ["good"]


PLANE = {"parameter": ["eps", "p"], "range": {"eps": [0.01, 1], "p": [0.1, 2]}}
COMPUTED = {  # what only computing finds
    "connection": {"start": {}, "as": "connection", **PLANE},
    "connection to": {
        "start": {}, "to": {}, "as": "connection", **PLANE,
    },
    "orbit": {"as": "orbit", "parameter": "p"},
    "orbit near rest": {"start": {"parameters": {"p": 0.01}}, "as": "orbit", "parameter": "p"},
}  # fmt: skip


@pytest.mark.parametrize("what", COMPUTED)
@pytest.mark.parametrize("form", ["polar", "cartesian"])
def test_of_an_averaged_model_that_fails_while_computing(tmp_path, what, form):
    failing = {"name": "failing", **COMPUTED[what]}
    runs = [failing, GOOD, {**GOOD, "name": "last"}]
    outputs = {"json": "r.json", "save": "r.contin"}
    file = run_file(tmp_path, WEAK, *runs, transform=[{"average": {"form": form}}], outputs=outputs)
    code = call("run", file, "-q")
    assert code == 1
    document = json.loads((tmp_path / "r.json").read_text())
    assert [branch["name"] for branch in document["branches"]] == ["good", "last"]
    assert any(note.startswith("failing skipped: ") for note in document["notes"])
    assert (tmp_path / "r.contin").exists()


def test_a_simulation_that_cannot_start_costs_neither_branches_nor_other_simulations(tmp_path, monkeypatch):
    from contin.errors import NotFiniteError
    from contin.runs import simulations as run

    def failing(model, start, parameters, original=run.simulate, **options):
        if options["time"] == 7:
            raise NotFiniteError("x has no value")
        return original(model, start, parameters, **options)

    monkeypatch.setattr(run, "simulate", failing)
    simulations = [{"name": "one", "time": 7}, {"name": "two", "time": 3, "csv": "two.csv"}]
    file = run_file(tmp_path, OSCILLATOR, GOOD, simulate=simulations, outputs={"json": "r.json"})
    assert call("run", file, "-q") == 1
    document = json.loads((tmp_path / "r.json").read_text())
    assert [branch["name"] for branch in document["branches"]] == ["good"]
    assert [entry["name"] for entry in document["simulations"]] == ["two"]
    assert document["notes"] == ["one skipped: x has no value"]
    assert (tmp_path / "two.csv").exists()
