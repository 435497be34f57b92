"""Scans and basins: a bistable equation in closed form; threads, resuming and a cluster give the same results."""

import json

import numpy as np
import pytest

from contin.errors import InputError
from contin.model.model import Model
from contin.simulate.scan.carry_out import carry_out
from contin.simulate.scan.grid import ScanSpec
from tests.cli.calls import call

MODEL = Model("bistable", states={"x": 1}, parameters={"p": 0}, equations={"x": "p + 3*x - x^3"})
CLASSES = {"upper": "x_min > 1", "lower": "x_max < -1"}


def spec(**changes):
    axes = (("p", np.linspace(-3.0, 3.0, 7)), ("x", np.array([-1.5, 1.5])))
    return ScanSpec(MODEL, **{"axes": axes, "classes": CLASSES, "settle": {"window": 20.0, "longest": 400.0}} | changes)


def test_each_start_settles_on_the_branch_of_its_basin():
    chosen = spec()
    rows = carry_out(chosen, threads=2)
    assert len(rows) == 14
    for job, outcome in rows.items():
        (p, x), _ = chosen.place(job)
        expected = "upper" if p > 2.0 or (p >= -2.0 and x > 0) else "lower"
        if abs(abs(p) - 2.0) > 0.1:
            assert outcome.label == expected


def test_the_basin_boundary_is_the_unstable_equilibrium():
    rows = carry_out(spec(axes=(("x", np.array([-0.02, -0.01, 0.01, 0.02])),)), threads=1)
    assert [rows[k].label for k in range(4)] == ["lower", "lower", "upper", "upper"]


def test_known_runs_are_not_computed_again():
    first = carry_out(spec(), threads=1)
    new = []
    again = carry_out(spec(), threads=1, known={k: first[k] for k in range(10)}, record=lambda job, _: new.append(job))
    assert sorted(new) == [10, 11, 12, 13]
    assert again == first


def test_waiting_has_an_end():
    drift = Model("drift", states={"x": 0}, parameters={"v": 1}, equations={"x": "v"})
    chosen = ScanSpec(drift, (("v", np.array([1.0])),), settle={"window": 10.0, "longest": 100.0})
    outcome = carry_out(chosen, threads=1)[0]
    assert outcome.outcome == "unsettled"
    assert outcome.time == pytest.approx(100.0)


def test_a_class_that_is_no_condition_is_refused():
    with pytest.raises(InputError, match="condition"):
        spec(classes={"odd": "x_max + 1"}).check()
    with pytest.raises(InputError, match="x_max"):
        spec(classes={"odd": "y_max > 1"}).check()


SCAN = {
    "contin": 1,
    "model": {"name": "bistable", "states": {"x": 1}, "parameters": {"p": 0}, "equations": {"x": "p + 3*x - x^3"}},
    "scan": {
        "axes": {"p": {"from": -3, "to": 3, "points": 7}, "x": [-1.5, 1.5]},
        "classes": CLASSES,
        "settle": {"window": 20, "longest": 400},
    },
    "outputs": {"save": "s.scan", "csv": "s.csv", "plot": "s.png"},
}  # fmt: skip


def test_a_scan_file_writes_table_and_picture_and_resumes(tmp_path, capsys):
    file = tmp_path / "s.yaml"
    file.write_text(json.dumps(SCAN))
    assert call("scan", file, "--threads", "2") == 0
    table = (tmp_path / "s.csv").read_text().splitlines()
    assert table[0].startswith("p,x,start,class,outcome,time,x_min")
    assert len(table) == 15
    assert (tmp_path / "s.png").stat().st_size > 10_000
    capsys.readouterr()
    assert call("scan", file, "--resume") == 0
    assert "14 of 14 runs were done" in capsys.readouterr().out
    assert (tmp_path / "s.csv").read_text().splitlines() == table


def test_another_scan_is_not_resumed(tmp_path, capsys):
    file = tmp_path / "s.yaml"
    file.write_text(json.dumps(SCAN))
    assert call("scan", file, "--quiet") == 0
    file.write_text(json.dumps(SCAN | {"parameters": {"p": 1}}))
    assert call("scan", file, "--resume") == 2
    assert "another scan" in capsys.readouterr().err


@pytest.mark.parametrize(("change", "message"), [
    ({"axes": {"q": [1]}}, "neither a parameter nor a state"),
    ({"settle": {"window": 20, "longest": 41}}, "four windows"),
    ({"settle": {"window": -1}}, "window"),
    ({"classes": {"odd": "y_max > 1"}}, "y_max"),
])  # fmt: skip
def test_mistakes_in_a_scan_file_end_with_one_message(tmp_path, capsys, change, message):
    file = tmp_path / "s.yaml"
    file.write_text(json.dumps(SCAN | {"scan": SCAN["scan"] | change}))
    assert call("scan", file) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "s.csv").exists()


def test_a_cluster_of_processes_finds_the_same():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        assert carry_out(spec(), cluster=cluster.scheduler_address) == carry_out(spec(), threads=1)
