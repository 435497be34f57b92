"""The one-file store and the exports hold the same results as the JSON."""

import csv
import json
import sqlite3

import pytest

from contin.errors import FormatVersionError, InputError
from contin.store import sqlite
from contin.store.json_format import result_document
from contin.store.results import export_results, read_results
from tests.plot.sample import bautin, branch, pitchfork


@pytest.fixture
def document():
    odd = branch("odd", {"x": [1.0, float("nan")], "n": [3, 4], "stable": [True, False]})
    model = {"name": "m", "states": ["x"], "parameters": {"p": 1.0}}
    return result_document(model, [*pitchfork(), *bautin(), odd], timing={"total": 1.0}, notes=["a note"])


@pytest.mark.parametrize("ending", [".contin", ".json"])
def test_what_is_saved_is_loaded_again_to_the_last_bit_and_type(document, tmp_path, ending):
    path = tmp_path / f"r{ending}"
    export_results(document, path)
    loaded = read_results(path)
    assert loaded == document
    assert [list(b) for b in loaded["branches"]] == [list(b) for b in document["branches"]]
    assert [type(v) for v in loaded["branches"][-1]["columns"]["n"]] == [int, int]
    assert loaded["branches"][-1]["columns"]["stable"] == [True, False]


def test_saving_again_replaces_the_file(document, tmp_path):
    path = tmp_path / "r.contin"
    sqlite.save(document, path)
    sqlite.save({**document, "branches": []}, path)
    assert sqlite.load(path)["branches"] == []
    assert [file.name for file in tmp_path.iterdir()] == ["r.contin"]


def test_files_that_are_no_store_are_refused(document, tmp_path):
    text = tmp_path / "text.contin"
    text.write_text("hello")
    other = tmp_path / "other.contin"
    sqlite3.connect(other).execute("CREATE TABLE t (x)").connection.close()
    newer = tmp_path / "newer.contin"
    sqlite.save(document, newer)
    connection = sqlite3.connect(newer)
    connection.execute("PRAGMA user_version = 99")
    connection.close()
    for path, error in ((text, InputError), (other, InputError), (newer, FormatVersionError)):
        with pytest.raises(error, match=str(path)):
            sqlite.load(path)
    with pytest.raises(InputError, match="no such file"):
        sqlite.load(tmp_path / "absent.contin")
    assert not (tmp_path / "absent.contin").exists()


def test_csv_has_a_row_for_every_row_with_its_label(document, tmp_path):
    path = tmp_path / "r.csv"
    export_results(document, path)
    rows = list(csv.DictReader(path.open()))
    assert len(rows) == sum(len(next(iter(b["columns"].values()))) for b in document["branches"])
    [fold] = [row for row in rows if row["label"] == "LPC1"]
    assert fold["branch"] == "cycles"
    assert float(fold["p"]) == -0.25
    assert fold["x"] == ""


def test_netcdf_groups_hold_the_columns(document, tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    path = tmp_path / "r.nc"
    export_results(document, path)
    with xarray.open_dataset(path, group="branch1") as fork:
        assert fork.attrs["name"] == "fork"
        assert float(abs(fork["x"] ** 2 - fork["p"]).max()) < 1e-15
        assert json.loads(fork.attrs["points"]) == document["branches"][1]["points"]
    with xarray.open_dataset(path) as root:
        assert root.attrs["contin"] == 1
        assert json.loads(root.attrs["model"]) == document["model"]
    assert [file.name for file in tmp_path.iterdir()] == ["r.nc"]


def test_an_unknown_ending_names_the_known_ones(document, tmp_path):
    with pytest.raises(InputError, match=r"\.json, \.contin, \.csv, \.nc"):
        export_results(document, tmp_path / "r.xlsx")
    with pytest.raises(InputError, match=r"\.contin or \.json"):
        read_results(tmp_path / "r.csv")
