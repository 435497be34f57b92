"""The picture of a run is drawn by a process of its own, or by the run where there is none."""

import os
import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from contin.cli import drawer as drawers
from contin.cli.outputs import outputs_of, write_all
from contin.plot.look import PLAIN_LOOK
from contin.plot.write import picture
from tests.plot.sample import pitchfork
from tests.plot.test_figure import document

RUN = """
contin: 1
model: {contin: 1, name: fold, states: {x: 1}, parameters: {p: {value: 1, range: [-1, 2]}}, equations: {x: p - x^2}}
continuations: [{name: line, start: {x: 1}, parameter: p, range: [-1, 2]}]
outputs: {json: found.json, plot: found.png}
"""
CALL = """
import sys
from contin.cli.main import main
sys.argv = ["contin", "run", "run.yaml", "--quiet"]
try:
    main()
finally:
    print("matplotlib" in sys.modules)
"""


@pytest.fixture
def results():
    return document(pitchfork())


@pytest.fixture
def drawer():
    made = drawers.begun(".png", PLAIN_LOOK)
    if made is None:
        pytest.skip("no process to be had")
    yield made
    made.dismiss()


def written(results, tmp_path, drawer):
    """The bytes of the picture that a run with this drawer leaves, and what troubled it."""
    place = tmp_path / "found.png"
    plan = SimpleNamespace(outputs={"plot": place}, look={}, simulations=(), sweep=None)
    said = []
    report = SimpleNamespace(print=said.append)
    done = write_all(outputs_of(plan, results, None, drawer=drawer), report, None)
    return place.read_bytes() if place.exists() else None, done.troubles


@pytest.mark.skipif(sys.platform != "linux", reason="the process is a copy of this one")
def test_it_draws_what_the_run_would_draw(results, tmp_path, drawer, monkeypatch):
    own = picture(results, ".png")
    drawer.begin(results)
    monkeypatch.setattr("contin.cli.outputs.write_picture", lambda *_: pytest.fail("the run draws itself"))
    assert written(results, tmp_path, drawer) == (own, [])


@pytest.mark.skipif(sys.platform != "linux", reason="the process is a copy of this one")
def test_where_it_is_gone_the_run_draws(results, tmp_path, drawer):
    os.kill(drawer.process, signal.SIGKILL)
    drawer.begin(results)
    assert written(results, tmp_path, drawer) == (picture(results, ".png"), [])


@pytest.mark.skipif(sys.platform != "linux", reason="the process is a copy of this one")
def test_what_it_cannot_draw_the_run_cannot_draw_either_and_says_why(results, tmp_path, drawer):
    for branch in results["branches"]:
        branch["columns"] = {}
    drawer.begin(results)
    data, troubles = written(results, tmp_path, drawer)
    assert data is None
    assert troubles


@pytest.mark.seldom
def test_a_run_does_not_wait_for_matplotlib(tmp_path):
    (tmp_path / "run.yaml").write_text(RUN)
    done = subprocess.run([sys.executable, "-c", CALL], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "found.png").read_bytes().startswith(b"\x89PNG")
    if sys.platform == "linux" and len(os.sched_getaffinity(0)) > 1:
        assert done.stdout.split() == ["False"]
