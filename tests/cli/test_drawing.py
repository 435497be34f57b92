"""The command draws the same picture although matplotlib writes no documentation of its classes there."""

import subprocess
import sys

import pytest

DRAW = """
import sys
{load}
from tests.plot.sample import pitchfork
from tests.plot.test_figure import document
from contin.plot.write import picture
import hashlib
print(hashlib.sha256(picture(document(pitchfork()), {suffix!r})).hexdigest())
from matplotlib.artist import Artist
from matplotlib.lines import Line2D
assert Line2D([], []).set(color="red")
class Own(Line2D):
    pass
assert "color" in (Own.set.__doc__ or "")
"""


@pytest.mark.parametrize("suffix", [".png"])
@pytest.mark.seldom
def test_pictures_have_the_same_bytes(suffix):
    found = []
    for load in ("", "from contin.cli.drawing import load_matplotlib; load_matplotlib()"):
        code = DRAW.format(load=load, suffix=suffix)
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        found.append(done.stdout)
    assert found[0] == found[1] != ""
