"""Model and run files of kind: pde through the command: labels, fields, messages, schema."""

import json
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contin
from contin.cli.main import main
from contin.model.yaml_reader import read_file
from contin.pde.schema import pde_schema

EXAMPLES = sorted(Path("examples/pde").glob("*.yaml"))
HEAD = "contin: 1\nname: case\nkind: pde\n"
GOOD = {
    "domain": "{x: {points: 11}}",
    "fields": "{u: 0}",
    "parameters": "{lam: 1}",
    "equations": "{u: dxx(u) + lam}",
    "boundary": "{all: u = 0}",
}


def written(**changes):
    return HEAD + "".join(f"{key}: {value}\n" for key, value in {**GOOD, **changes}.items())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"domain": "{x: {points: 2}}"}, "domain.x.points: expected a whole number of nodes from 3"),
        ({"domain": "{x: {points: 11, method: chebychev}}"}, "domain.x.method: expected 'differences', 'chebyshev' or"),
        ({"domain": "{x: {points: 11, from: 1}}"}, "domain.x: expected from < to, got 1 and 1"),
        ({"domain": "{x: {points: 11, to: lam}}"}, "domain.x.to: the ends of a domain are numbers"),
        ({"domain": "{x: {points: 11}, y: {points: 11}, z: {points: 11}}"}, "domain: a domain has one axis or two"),
        ({"domain": "{x: {points: 2000}, y: {points: 2000}}"}, "domain: 4000000 nodes; at most 1000000 are taken"),
        ({"fields": "{x: 0}"}, "fields.x: x is already declared under domain"),
        ({"equations": "{u: dxxx(u)}"}, "the derivative of order 3 of u along x is not made"),
        ({"equations": "{u: dyy(u)}"}, "equations.u: 'dyy': derivatives of a field u along an axis x are dx(u)"),
        ({"equations": "{u: 'dxx(u, 2)'}"}, "dxx takes 1 argument, as in dxx(u)"),
        ({"equations": "{v: dxx(u)}"}, "equations.v: v is not a field: fields are u"),
        ({"boundary": "{x.start: u = 0}"}, "no condition for u at x.end; add `u = 0` or `dn(u) = 0` under boundary."),
        ({"boundary": "{all: [u = 0, dn(u) = 1]}"}, "boundary.all[1]: a second condition for u at x.start"),
        ({"boundary": "{left: u = 0}"}, "there is no side 'left'; sides are x.start, x.end, all"),
        ({"boundary": "{all: u^2 = 1}"}, "u must occur linearly in a condition: write u = ..."),
        ({"boundary": "{all: dxx(u) = 0}"}, "conditions are for a field or its slope dx there"),
        ({"boundary": "{all: u}"}, "a condition is an equation with one `=`, such as u = 0"),
        ({"domain": "{x: {points: 11, method: fourier}}"}, "there is no side 'all'"),
        ({"observables": "{a: u(2)}"}, "observables.a: x = 2 lies outside the domain [0, 1]"),
        ({"observables": "{a: u}"}, "u has a value everywhere: write integral(u)"),
        ({"starts": "{far: {w: 1}}"}, "starts.far.w: not a field: there are u"),
        ({"nodes": "3"}, "nodes: unknown key"),
    ],
)  # fmt: skip
def test_mistakes_are_told_at_their_place(tmp_path, changes, message):
    file = tmp_path / "case.yaml"
    file.write_text(written(**changes))
    with pytest.raises(contin.InputError) as error:
        contin.load(file)
    told = str(error.value)
    assert message in told
    assert told.startswith(f"{file}:")


def test_a_run_file_with_starts_values_and_fields(tmp_path, capsys):
    changes = {"equations": "{u: dxx(u) + lam*exp(u)}", "parameters": "{lam: 0}", "observables": "{top: u(1/2)}"}
    (tmp_path / "case.yaml").write_text(written(**changes))
    run = {
        "contin": 1, "model": "case.yaml",
        "continuations": [
            {"name": "low", "parameter": "lam", "range": [0, 4], "values": {"top": [1.0]}, "settings": {"steps": 40}},
            {"name": "high", "start": {"u": "4*sin(pi*x)", "parameters": {"lam": 1}}, "parameter": "lam",
             "range": [0.9, 1.1]},
        ],
    }  # fmt: skip
    (tmp_path / "run.yaml").write_text(json.dumps(run))
    with pytest.raises(SystemExit):
        main(["run", str(tmp_path / "run.yaml"), "--orbits", "--json", str(tmp_path / "out.json")])
    assert "case (u on x: 9 unknowns)" in " ".join(capsys.readouterr().out.split())
    found = json.loads((tmp_path / "out.json").read_text())
    low, high = found["branches"]
    labels = {p["label"]: p for p in low["points"]}
    assert labels["LP1"]["values"]["lam"] == pytest.approx(3.5138, abs=0.03)
    fields = labels["UZ1"]["fields"]
    assert len(fields["x"]) == len(fields["u"]) == 11
    assert fields["u"][0] == 0.0
    assert max(fields["u"]) == pytest.approx(1.0)
    assert min(high["columns"]["top"]) > 3.5


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda f: f.stem)
def test_examples_agree_with_the_schema(file):
    data = read_file(file).data
    model = {"contin": 1, **data["model"]} if "model" in data else data  # a run file, or a model alone
    assert not list(Draft202012Validator(pde_schema()).iter_errors(model))


@pytest.mark.parametrize(("name", "tolerance"), [("bru", 2e-3), ("brc", 1e-6)])
def test_hopf_points_of_the_brusselator(name, tolerance):
    run = read_file(f"examples/pde/{name}.yaml").data
    line = contin.continuation(contin.load(run["model"]), "L", (0.4, 1.2))
    exact = np.pi * np.sqrt(0.012 / 0.45) * np.array([1, 2])
    np.testing.assert_allclose([p.values["L"] for p in line.points if p.type == "HB"], exact, rtol=tolerance)


def test_where_a_population_between_absorbing_ends_survives():
    # u_t = D u_xx + r u (1 - u), u = 0 at the ends of (0, 10): r_k = D (k pi/10)^2
    run = read_file("examples/pde/pd1.yaml").data
    line = contin.continuation(contin.load(run["model"]), "growth", (0, 0.05))
    exact = 0.1 * (np.pi / 10) ** 2 * np.array([1, 4])
    np.testing.assert_allclose([p.values["growth"] for p in line.points], exact, rtol=1e-9)
    assert not line.notes  # a test that is a sign says nothing of the kind of zero


def test_where_prey_survive_among_predators_that_are_fed_in_at_the_ends():
    """pd2: the lowest p of w'' + (p - cosh(x)/cosh(1/2)) w = 0, w = 0 at the ends of (-1/2, 1/2), by shooting."""

    def end(p: float) -> float:
        def right(x: float, w: np.ndarray) -> list[float]:
            return [w[1], (np.cosh(x) / np.cosh(0.5) - p) * w[0]]

        return float(solve_ivp(right, (0, 0.5), [1, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[0, -1])

    run = read_file("examples/pde/pd2.yaml").data
    line = contin.continuation(contin.load(run["model"]), "growth", (5, 15))
    (point,) = line.points
    assert point.values["growth"] == pytest.approx(brentq(end, 9, 12, xtol=1e-12), rel=1e-9)
