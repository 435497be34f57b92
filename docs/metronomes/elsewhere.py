"""Results that several pages look at: made by `contin run` on the first page of a build, taken over by the others."""

import os
import shutil
from pathlib import Path

from contin.cli.main import main

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
            try:
                main(["run", f"metronomes/{name}", "--quiet"])
            except SystemExit as end:
                if end.code:
                    raise RuntimeError(f"the run {name} ended with exit code {end.code}") from end
            keep(name)
