"""The small beats of the pair of metronomes as tori: the page's own checks, on its run files."""

import importlib
import json
import sys

import pytest

from tests.cli.calls import call
from tests.docs.test_pages import DOCS

sys.path.insert(0, str(DOCS / "metronomes"))


@pytest.mark.long
def test_small_beats_end_below_those_of_the_average_by_the_order_of_eps(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("pair-tori", "pair-small-beats"):
        assert call("run", f"metronomes/{name}", "--quiet") == 0
    tori = importlib.import_module("tori")
    tori.check()
    fresh = tori.trimmed(json.loads((tmp_path / "pair-tori.json").read_text()))["branches"]
    kept = json.loads(tori.STORED.read_text())["branches"]
    assert [branch["name"] for branch in fresh] == [branch["name"] for branch in kept]
    for one, other in zip(fresh, kept, strict=True):  # the page draws what the run finds
        assert abs(one["ends"][1]["at"]["mu"] - other["ends"][1]["at"]["mu"]) < 1e-6
        assert abs(max(one["columns"]["x1.max"]) - max(other["columns"]["x1.max"])) < 1e-3


def test_the_stored_tori_pass_the_checks_of_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call("run", "metronomes/pair-small-beats", "--quiet") == 0
    importlib.import_module("tori").check()
