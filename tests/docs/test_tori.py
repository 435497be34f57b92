"""The small beats of the pair of metronomes as tori: the page's own checks, on its run files."""

import importlib
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
    importlib.import_module("tori").check()
