"""`import contin`: light, and its verbs stay verbs whatever is imported."""

import subprocess
import sys

import contin


def run(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


def test_importing_contin_loads_no_numerical_library():
    loaded = run("import sys, contin; print(*sys.modules)").split()
    assert not {"numpy", "scipy", "sympy", "numba", "ruamel", "pydantic"} & set(loaded)


def test_verbs_that_share_their_name_with_a_subpackage_stay_callable():
    code = (
        "import contin, contin.continuation.branch, contin.diagram.diagram\n"
        "from contin.continuation.settings import Settings\n"
        "from contin.diagram.explore import Explorer\n"
        "verbs = ('continuation', 'diagram', 'equilibrium', 'walk', 'load')\n"
        "print(all(callable(getattr(contin, name)) for name in verbs))"
    )
    assert run(code) == "True\n"


def test_every_exported_name_exists():
    assert [name for name in contin.__all__ if not hasattr(contin, name)] == []
