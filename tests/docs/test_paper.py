"""The paper of the metronomes: numbers are filled in by name, and none is left over or missing."""

import importlib
import sys

import pytest

from tests.docs.test_pages import DOCS

sys.path.insert(0, str(DOCS / "metronomes"))
build = importlib.import_module("build_paper")


def test_numbers_are_filled_in_and_a_missing_or_unused_one_is_an_error():
    assert build.filled("mu = {{one}}", {"one": "4.7"}) == "mu = 4.7"
    for values in ({}, {"one": "1", "two": "2"}):
        with pytest.raises(ValueError, match="differ"):
            build.filled("mu = {{one}}", values)


def test_every_run_file_that_the_paper_names_is_carried_out_for_it():
    folder = DOCS.parent / "models"
    text = (DOCS / "metronomes" / "paper.md").read_text(encoding="utf-8")
    for name in build.RUNS:
        assert (folder / "metronomes" / "runs" / f"{name}.yaml").exists()
        assert name in text
