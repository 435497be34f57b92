"""Results of the demos of AUTO-07p, as run files: each is computed once for all tests that look at it."""

import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.cli.calls import call

FOLDER = Path(__file__).parents[3] / "examples" / "auto"
WITH_ORBITS = ("ffn", "kdv3", "lor", "rev")


@cache
def result_of(name):
    """The results of a demo's run file, which several tests look at."""
    with TemporaryDirectory() as folder:
        return result_of_file(FOLDER / f"{name}.yaml", folder, *(["--orbits"] if name in WITH_ORBITS else []))


def result_of_file(path, folder, *options):
    out = Path(folder) / "out.json"
    call("run", str(path), "--quiet", *options, "--json", str(out))
    return json.loads(out.read_text())


def branches_of(name):
    """The branches of a demo's run file, by name."""
    return {branch["name"]: branch for branch in result_of(name)["branches"]}
