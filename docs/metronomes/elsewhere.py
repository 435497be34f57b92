"""Results that several pages look at: made by `contin run` on the first page of a build, taken over by the others."""

import os
import shutil
import subprocess
from pathlib import Path

SHARED = "CONTIN_DOCS_RUNS"  # the folder that `conf.py` makes for a build


def keep(*names: str) -> None:
    """The JSON results of runs in this page's folder are there for other pages."""
    if SHARED in os.environ:
        for name in names:
            shutil.copy(f"{name}.json", os.environ[SHARED])


def take(*names: str) -> None:
    """The results of `metronomes/NAME` in this page's folder: from another page, or from a run where there are none."""
    for name in names:
        kept = Path(os.environ.get(SHARED, os.curdir), f"{name}.json")
        if SHARED in os.environ and kept.exists():
            shutil.copy(kept, os.curdir)
        else:
            subprocess.run(["contin", "run", f"metronomes/{name}", "--quiet"], check=True)
            keep(name)
