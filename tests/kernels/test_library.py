"""Machine code is found or made, kept by what it was made from, checked when it is read, and never trusted blindly."""

import os
import stat

import pytest

from contin.kernels import grading, library
from contin.kernels.callees import declared
from contin.machine import objects
from contin.machine.folder import open_folder
from tests.kernels.small import CALLEE, copy, run


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """A copy of contin, and a cache that holds its kernels."""
    folder = copy(tmp_path_factory.mktemp("copy"))
    cache = folder / "cache"
    assert run(folder, cache=cache)[0] == "8.0"
    return folder, cache / "machine-code"


def files(kept):
    return sorted(path for path in kept.iterdir() if path.name.startswith(("callee.", "caller.")))


def test_kernels_are_kept_and_nothing_is_made_again(home):
    folder, kept = home
    assert {path.name.split("-")[0] for path in files(kept)} == {"callee.value", "caller.twice"}
    assert stat.S_IMODE(kept.stat().st_mode) == 0o700
    before = [path.stat().st_mtime_ns for path in files(kept)]
    out, errors = run(folder, cache=kept.parent)
    assert (out, errors) == ("8.0", "")
    assert [path.stat().st_mtime_ns for path in files(kept)] == before


def test_a_process_that_computes_does_not_import_numba(home):
    folder, kept = home
    code = "from contin.kernels.caller import twice; import sys; twice(3.0); print('numba' in sys.modules)"
    assert run(folder, code, cache=kept.parent)[0] == "False"


def test_a_copy_at_another_path_shares_the_cache(home, tmp_path):
    _, kept = home
    assert run(copy(tmp_path / "elsewhere"), cache=kept.parent) == ("8.0", "")


def test_an_edit_of_a_callee_in_another_file_is_seen(home, tmp_path):
    """The caller's file and its machine code did not change; what it is linked with did."""
    _, kept = home
    folder = copy(tmp_path / "edited", "x + 1.0")
    (folder / "contin" / "kernels" / "callee.py").write_text(CALLEE.format(expression="x + 2.0"))
    out, errors = run(folder, cache=kept.parent)
    assert out == "10.0"
    assert "2 kernels" in errors


DAMAGE = {
    "empty": lambda b: b"", "truncated": lambda b: b[:-1], "flipped": lambda b: b[:99] + bytes([b[99] ^ 4]) + b[100:]
}  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_damage_of_a_file_is_seen(home, damage):
    for path in files(home[1]):
        assert objects.from_bytes(path.read_bytes()) is not None
        assert objects.from_bytes(damage(path.read_bytes())) is None


@pytest.mark.parametrize(
    "damage",
    [pytest.param(one, id=name, marks=() if name == "flipped" else pytest.mark.long) for name, one in DAMAGE.items()],
)  # whatever the damage is, it has been seen above
def test_a_damaged_file_is_made_anew_with_a_note(home, damage):
    folder, kept = home
    for path in files(kept):
        path.write_bytes(damage(path.read_bytes()))
        assert objects.from_bytes(path.read_bytes()) is None
    out, errors = run(folder, cache=kept.parent)
    assert out == "8.0"
    assert errors.count("was damaged: it is made anew") == 2
    assert run(folder, cache=kept.parent) == ("8.0", "")
    for path in files(kept):
        if objects.from_bytes(path.read_bytes()) is None:  # of another version: nobody asked for it
            path.unlink()


def test_without_a_home_kernels_live_in_memory(home, tmp_path):
    folder, _ = home
    code = "import os, pwd; pwd.getpwuid = lambda _: {}['no entry'];"
    code += "from contin.machine.folder import folder; print(folder());"
    code += "from contin.kernels.caller import twice; print(twice(3.0))"
    assert run(folder, code)[0].split() == ["None", "8.0"]


def test_a_folder_that_others_may_enter_is_not_used(tmp_path):
    path = tmp_path / "machine-code"
    path.mkdir(mode=0o755)
    assert open_folder(path) is None
    path.chmod(0o700)
    assert open_folder(path) is not None
    link = tmp_path / "link"
    link.symlink_to(path)
    assert open_folder(link) is None
    (tmp_path / "file").touch()
    assert open_folder(tmp_path / "file") is None


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give a folder away")
def test_a_folder_of_somebody_else_is_not_used(tmp_path):
    path = tmp_path / "machine-code"
    path.mkdir(mode=0o700)
    os.chown(path, 12345, -1)
    assert open_folder(path) is None


def test_a_full_disk_costs_the_cache_and_nothing_else(tmp_path, monkeypatch):
    kept = open_folder(tmp_path / "machine-code")

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    assert not kept.write("name", b"data")
    assert kept.names() == []


def test_without_numba_and_without_machine_code_the_message_says_what_to_install(home, tmp_path):
    folder, _ = home
    code = (
        "import contin.kernels.pool as pool; pool.find_spec = lambda name: None\n"
        "from contin.kernels.caller import twice\n"
        "try: twice(1.0)\n"
        "except pool.KernelError as error: print(error)"
    )
    assert run(folder, code, cache=tmp_path / "empty")[0].endswith("pip install numba")


def test_an_error_in_a_kernel_is_told_by_name(home, tmp_path):
    folder = copy(tmp_path / "wrong", "x + undefined")
    code = (
        "from contin.kernels.caller import twice\n"
        "from contin.kernels.pool import KernelError\n"
        "try: twice(1.0)\n"
        "except KernelError as error: print(error)"
    )
    assert "the kernel callee.value could not be compiled" in run(folder, code, cache=tmp_path / "empty")[0]


def test_what_an_equilibrium_needs_first_leaves_out_what_is_only_put_in_place():
    pieces = {d.name: d for d in library._companions(declared(grading.grade))}
    assert {"algebraic.march", "defining.evaluate", "rest_of_step.is_clear"} <= pieces.keys()
    assert [name for name, d in pieces.items() if d.inlined] == ["steering.is_dip"]  # the one that Python calls, too
