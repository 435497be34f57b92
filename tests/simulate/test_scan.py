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


@pytest.mark.seldom
def test_a_cluster_of_processes_finds_the_same():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        assert carry_out(spec(), cluster=cluster.scheduler_address) == carry_out(spec(), threads=1)


def test_what_a_killed_scan_has_committed_is_resumed_and_can_be_drawn(tmp_path, monkeypatch):
    import shutil

    from contin.simulate.scan.carry_out import document_of
    from contin.store import scan_store

    monkeypatch.setattr(scan_store, "LATEST", -1.0)  # every run is committed
    chosen, path = spec(), tmp_path / "whole" / "s.scan"
    path.parent.mkdir()
    rows = carry_out(chosen, threads=1)
    store = scan_store.ScanStore(path, "mark", document_of(chosen, {}), False)
    for job in range(9):
        store.add(job, rows[job])
    shutil.copytree(path.parent, tmp_path / "killed")  # as a kill leaves the files
    store.close()
    left = tmp_path / "killed" / "s.scan"
    assert scan_store.read_scan(left)["columns"] == document_of(chosen, {k: rows[k] for k in range(9)})["columns"]
    assert call("plot", left, "--out", tmp_path / "s.png") == 0
    assert call("export", left, tmp_path / "s.csv") == 0
    assert len((tmp_path / "s.csv").read_text().splitlines()) == 10
    resumed = scan_store.ScanStore(left, "mark", document_of(chosen, {}), True)
    assert resumed.rows == {k: rows[k] for k in range(9)}
    resumed.close()


def test_a_cluster_that_is_not_there_is_named(tmp_path, capsys):
    distributed, dask = pytest.importorskip("distributed"), pytest.importorskip("dask")
    file = tmp_path / "s.yaml"
    file.write_text(json.dumps(SCAN | {"outputs": {}}))
    assert call("scan", file, "--cluster", "nonsense://x") == 2
    assert "no scheduler answers there" in capsys.readouterr().err
    # and the process forgets it: whatever uses dask later must not be sent to the client that failed
    assert dask.config.get("scheduler", None) is None
    with pytest.raises(ValueError, match="No client"):
        distributed.default_client()


def test_beating_is_settled_by_windows_that_grow():
    # x = (1 + cos(w t)/2) cos t: the modulus beats with any period, however long beside the first window
    model = Model(
        "beat", states={"a": 1, "b": 0}, parameters={"w": 0.01}, equations={"a": "-w*b", "b": "w*a"},
        observables={"r": "1 + a/2"},
    )  # fmt: skip
    chosen = ScanSpec(
        model, (("w", np.array([0.002, 0.3])),), measures={"r": "1 + a/2"}, settle={"window": 30.0, "longest": 2e5},
        classes={"beating": "r_max - r_min > 0.9"},
    )  # fmt: skip
    outcomes = list(carry_out(chosen, threads=1).values())
    assert [outcome.label for outcome in outcomes] == ["beating", "beating"]
    for outcome in outcomes:
        assert outcome.outcome == "settled"
        assert outcome.statistics["r_mean"] == pytest.approx(1.0, abs=1e-3)
        assert outcome.statistics["r_max"] == pytest.approx(1.5, abs=1e-3)


def test_a_state_that_is_about_to_be_left_is_not_settled():
    # x' = x (1 - x) from 1e-3: for a long time next to nothing changes, but what changes grows
    model = Model("leaving", states={"x": 1e-3}, parameters={"c": 0.01}, equations={"x": "c*x*(1 - x)"})
    chosen = ScanSpec(model, (("c", np.array([0.01])),), settle={"window": 10.0, "longest": 1e4})
    outcome = carry_out(chosen, threads=1)[0]
    assert outcome.statistics["x_max"] == pytest.approx(1.0, abs=1e-3)
