"""Branches as data frames and datasets hold the columns bit for bit, with their labels."""

import json
import sys

import numpy as np
import pytest

import contin
from contin.errors import InputError

FOLD = contin.Model("fold", states={"x": 1.0}, parameters={"p": 1.0}, equations={"x": "p - x^2"})


def test_a_data_frame_holds_the_columns_and_labels():
    pandas = pytest.importorskip("pandas")
    branch = contin.continuation(contin.equilibrium(FOLD), "p", (-1, 2))
    frame = branch.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == ["label", *branch.columns]
    for name, column in branch.columns.items():
        assert frame[name].to_numpy().tobytes() == column.tobytes()
    [fold] = frame.index[frame.label == "LP1"]
    assert fold == branch["LP1"].index
    np.testing.assert_allclose(frame.p, frame.x**2, atol=1e-12)


def test_a_diagram_is_one_data_frame_by_branch_and_row():
    pytest.importorskip("pandas")
    model = contin.Model("pitchfork", states={"x": 0.0}, parameters={"p": -1.0}, equations={"x": "p*x - x^3"})
    diagram = contin.diagram(model, "p", (-1, 1))
    frame = diagram.to_dataframe()
    assert list(frame.index.names) == ["branch", "row"]
    assert set(frame.index.get_level_values("branch")) == {branch.name for branch in diagram}
    fork = frame.loc[diagram.branches[1].name]
    np.testing.assert_allclose(fork.x**2, fork.p, atol=1e-9)


@pytest.mark.seldom
def test_a_dataset_says_what_the_branch_is():
    pytest.importorskip("xarray")
    branch = contin.continuation(contin.equilibrium(FOLD), "p", (-1, 2), name="line")
    data = branch.to_xarray()
    assert data.sizes == {"row": len(branch)}
    assert (data.attrs["name"], data.attrs["kind"]) == ("line", "equilibrium")
    at = data.where(data.label == "LP1", drop=True)
    assert float(at.p[0]) == branch["LP1"].values["p"]
    assert json.loads(data.attrs["points"])["LP1"]["p"] == branch["LP1"].values["p"]


def test_a_missing_library_is_named(monkeypatch):
    branch = contin.continuation(contin.equilibrium(FOLD), "p", (0.5, 2))
    for name in ("pandas", "xarray"):
        monkeypatch.setitem(sys.modules, name, None)  # an import of it fails
    with pytest.raises(InputError, match=r"pandas is not installed: pip install 'contin\[frames\]'"):
        branch.to_dataframe()
    with pytest.raises(InputError, match="xarray is not installed"):
        branch.to_xarray()
