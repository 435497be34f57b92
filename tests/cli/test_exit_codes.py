"""Exit code 1 if and only if `unstable` changes between two rows without a label (FORMATS), whatever the notes say.

The number of unstable eigenvalues of x = 0 is known in closed form; labels are rows whose critical eigenvalue is not
counted, so that between the unlabelled rows around a label it may change by one.
"""

import pytest
import yaml

from tests.cli.calls import call, results, run_file

LABELLED = {
    "p*x - x^3": 1,
    "p^3*x - x^3": 1,  # no simple crossing, one change
    "p^2*x - x^3": 1,  # touches: no change, and branches meet
    "-p^4*x - x^3": 1,
    "-x*(x - p^2)": 1,  # two branches touch
    "p*(p - 1e-3)*(p + 1e-3)*x - x^3": 3,
    "(p - 1e-7)*(p + 1e-7)*x - x^3": 2,
}
UNLABELLED = {
    "(heaviside(p) - 1/2)*x - x^3": True,  # the rate jumps past zero: nothing is born by continuity
    "(sign(p) + 2)*x - x^3": False,  # it jumps, on one side of zero
    "-(2 + p)*x - x^3": False,
}


def line_of(tmp_path, rate):
    model = {"contin": 1, "name": "line", "states": {"x": 0.0}, "parameters": {"p": -1.0}, "equations": {"x": rate}}
    out = tmp_path / "out.json"
    run = {"name": "line", "parameter": "p", "range": [-1, 1.07]}
    code = call("run", run_file(tmp_path, model, run), "--json", out)
    [branch] = results(out)["branches"]
    return code, branch


def changes(branch):
    """How often `unstable` differs between two neighbouring rows that have no label."""
    marked = {point["index"] for point in branch["points"]}
    column = branch["columns"]["unstable"]
    pairs = [(k, k + 1) for k in range(len(column) - 1) if not {k, k + 1} & marked]
    return sum(column[a] != column[b] for a, b in pairs)


@pytest.mark.parametrize("rate", LABELLED)
def test_changes_with_a_label_leave_exit_code_0(tmp_path, rate):
    code, branch = line_of(tmp_path, rate)
    assert code == 0
    assert 1 <= len(branch["points"]) <= LABELLED[rate]
    assert changes(branch) == 0


@pytest.mark.parametrize(("rate", "changed"), UNLABELLED.items())
def test_a_change_without_a_label_is_exit_code_1_and_a_note(tmp_path, rate, changed):
    code, branch = line_of(tmp_path, rate)
    assert branch["points"] == []
    assert changes(branch) == int(changed)
    assert code == int(changed)


def test_a_start_from_which_no_branch_can_be_followed_is_exit_code_1(tmp_path):
    model = {  # of the circle of equilibria x^2 + y^2 = 1 no point has a unique tangent
        "contin": 1, "name": "circle", "states": {"x": 1.0, "y": 0.0}, "parameters": {"p": 0.0},
        "equations": {"x": "x*(1 - x^2 - y^2)", "y": "y*(1 - x^2 - y^2)"},
    }  # fmt: skip
    out = tmp_path / "out.json"
    diagram = {"parameter": "p", "range": [-1, 1]}
    path = tmp_path / "run.yaml"
    path.write_text(yaml.safe_dump({"contin": 1, "model": model, "diagram": diagram}, sort_keys=False))
    assert call("run", path, "--json", out) == 1
    document = results(out)
    assert document["branches"] == []
    assert any("singular" in note for note in document["notes"])
