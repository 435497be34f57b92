"""`contin plane` as a command: pictures, a page with a slider, JSON, messages."""

import json
import re

import pytest
from typer.testing import CliRunner

from contin.cli.main import app
from contin.plane.page import plane_page, planes_along

MODEL = """contin: 1
name: fhn
title: "<script>alert(1)</script>"
states: {v: -1, w: -0.5}
parameters: {I: 0.5, eps: 0.08}
equations: {v: v - v^3/3 - w + I, w: eps*(v + 0.7 - 0.8*w)}
"""


@pytest.fixture
def model(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fhn.yaml").write_text(MODEL)
    return tmp_path / "fhn.yaml"


def test_pictures_and_numbers(model):
    done = CliRunner().invoke(
        app, ["plane", "fhn.yaml", "v", "w", "--from", "-2,1.5", "-o", "a.svg", "--json", "a.json"]
    )
    assert done.exit_code == 0, done.output
    assert "stable cycle of period 39.4744" in done.output
    document = json.loads((model.parent / "a.json").read_text())
    assert document["equilibria"][0]["type"] == "unstable focus"
    assert {len(p) for p in document["nullclines"]["v"][0]} == {2}
    assert (model.parent / "a.svg").read_text().startswith("<?xml")


@pytest.mark.seldom
def test_a_page_with_a_slider(model):
    found = planes_along(_loaded(model), "v", "w", "I", 0.0, 1.5, 3)
    assert [bool(p.cycles) for p in found] == [False, True, False]  # Hopf points at I = 0.3313 and 1.4187
    assert len({p.window.tobytes() for p in found}) == 1
    page = plane_page(found, "I")
    assert page.count("data:image/svg+xml;base64") == 3
    assert "<script>alert" not in page
    assert not re.search(r"(src|href)=.https?:", page)


def _loaded(path):
    from contin.model.registry import load

    return load(str(path))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["v", "z"], "no state 'z'"),
        (["v", "w", "--from", "1"], "--from 1: write two numbers"),
        (["v", "w", "--at", "w=1"], "on an axis"),
        (["v", "w", "-o", "a.gif"], "pictures end in"),
        (["v", "w", "--parameter", "I", "0", "1", "-o", "a.png"], "an animation is a page"),
        (["v", "w", "--parameter", "J", "0", "1"], "no parameter 'J'"),
    ],
)
def test_messages(model, arguments, words):
    from contin.errors import InputError

    done = CliRunner().invoke(app, ["plane", "fhn.yaml", *arguments])
    assert isinstance(done.exception, InputError)
    assert words in str(done.exception)
    assert [path.name for path in model.parent.iterdir()] == ["fhn.yaml"]
