"""Property tests: the same examples in every run; the first call of a kernel may compile for seconds.

numpy and BLAS compute as the command has them do, with the level of machine code and one thread, so that the same
digits are tested on every processor. `CONTIN_TARGET=x86-64-v2` tests those of another level, and
`CONTIN_TEST_LIBRARIES=processor` what numpy and BLAS choose by themselves, `CONTIN_TEST_NOISE=1` (any number) what
rounding may do anywhere (`tests/noise.py`), `CONTIN_TEST_UNWRITTEN=1` what memory held before may do
(`tests/unwritten.py`): the tests must pass with each.

`pytest -m fast` runs the core in under a minute once the kernels are compiled: what is in `FAST`, marked here.
"""

import gc
import os
import sys
from pathlib import Path

if os.environ.get("CONTIN_TEST_LIBRARIES") == "processor":
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # read when numpy is imported, here and in processes that tests start
else:
    from contin.machine import environment

    environment.fix()

import pytest
from hypothesis import settings

if os.environ.get("CONTIN_TEST_NOISE"):
    from tests.noise import add_noise

    add_noise(int(os.environ["CONTIN_TEST_NOISE"]))

if os.environ.get("CONTIN_TEST_UNWRITTEN"):
    from tests.unwritten import fill_new_arrays

    fill_new_arrays()

settings.register_profile("contin", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("contin")

gc.disable()  # collecting makes half a million objects and no garbage: a quarter of its time was spent looking for some

FAST = """
    continuation kernels lowering machine model normalforms simulate symbolic
    systems/functions loci/equilibria problems/maps/test_maps.py problems/equilibria/test_corners.py
    problems/orbits/test_defining.py problems/orbits/test_ends.py problems/orbits/test_meshes.py
    search/test_equilibrium_from_guess.py diagram/test_diagram.py diagram/phase/test_plane.py store/test_sqlite.py
    cli/test_bad_input.py special
""".split()
SLOW = """
    kernels/test_library.py lowering/test_alike.py machine/test_no_libm.py model/test_fuzz.py model/test_kept.py
    model/test_printing.py normalforms/test_multiple.py normalforms/test_two_modes.py systems/functions/test_trials.py
    loci/equilibria/test_invariance.py loci/equilibria/test_normal_forms.py loci/equilibria/test_published.py
    problems/equilibria/test_labels.py simulate/test_scan.py symbolic/test_averaging_one.py
    symbolic/test_averaging_several.py symbolic/test_derived.py symbolic/test_reach.py
    symbolic/test_remove_singularities.py symbolic/test_second_order.py
""".split()
HERE = Path(__file__).parent


def pytest_collection_finish():
    """What was collected lives to the end, and is not looked through again."""
    gc.freeze()
    gc.enable()
    gc.set_threshold(50_000, 20, 20)  # 700, 10, 10 look through models and kernels again and again: 4 % of the time


def pytest_runtest_setup(item):
    """The digits of mpmath that an earlier test asked for are not those of the next."""
    if "mpmath" in sys.modules:
        sys.modules["mpmath"].mp.prec = 53


_warned = []


def pytest_warning_recorded(warning_message, nodeid):
    """Numbers that overflow, or divide rounding by rounding, are looked into: a coefficient was wrong behind one."""
    if issubclass(warning_message.category, RuntimeWarning):
        _warned.append(f"{nodeid}: {warning_message.message} ({warning_message.filename}:{warning_message.lineno})")


def pytest_terminal_summary(terminalreporter):
    for line in _warned:
        terminalreporter.write_line(f"WARNED {line}", red=True)


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session):
    if _warned and session.exitstatus == 0:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def is_fast(path: Path) -> bool:
    """Whether a file is, or is in, one of `FAST` and none of `SLOW`."""
    if not path.is_relative_to(HERE):
        return False
    relative = path.relative_to(HERE)
    inside = {relative.as_posix(), *(parent.as_posix() for parent in relative.parents)}
    return bool(inside & set(FAST)) and not inside & set(SLOW)


def pytest_ignore_collect(collection_path, config):
    """With `-m fast` other files are not even imported."""
    if config.option.markexpr == "fast" and collection_path.is_file() and not is_fast(collection_path):
        return True
    return None


def pytest_collection_modifyitems(items):
    """Marks what is `fast`; long versions of its tests are not."""
    for item in items:
        if is_fast(item.path) and not item.get_closest_marker("long"):
            item.add_marker("fast")
