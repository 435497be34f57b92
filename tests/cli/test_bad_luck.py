"""A full disk, a reader that goes away, a folder that may not be written to: one message, and nothing else is lost."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from contin.errors import InputError
from contin.store.atomic import write_text
from tests.cli.calls import FOLD, call, results, run_file
from tests.faults.processes import finished, kept, needs_fork, short_chunks, started, wait_for

FULL = Path("/dev/full")  # takes nothing: "No space left on device"
needs_full = pytest.mark.skipif(not FULL.is_char_device(), reason="needs /dev/full")
COMMAND = [sys.executable, "-m", "contin"]


@needs_full
@pytest.mark.parametrize("arguments", [["run", "case.yaml"], ["run", "case.yaml", "-q", "--json", "-"], ["models"]])
@pytest.mark.seldom
def test_a_full_disk_behind_standard_output_is_said_and_the_files_are_written(tmp_path, arguments):
    run_file(tmp_path, FOLD, {"parameter": "p"}, outputs={"json": "kept.json", "save": "kept.contin"})
    with FULL.open("w") as full:
        done = subprocess.run(
            [*COMMAND, *arguments], cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 1
    assert done.stderr == "standard output: No space left on device\n"
    if arguments[0] == "run":
        [fold] = results(tmp_path / "kept.json")["branches"][0]["points"]
        assert fold["values"]["p"] == pytest.approx(0, abs=1e-12)
        assert call("export", tmp_path / "kept.contin", tmp_path / "again.json") == 0


@needs_full
def test_one_output_that_does_not_fit_leaves_the_others_whole(tmp_path, capsys):
    path = run_file(tmp_path, FOLD, {"parameter": "p"}, outputs={"json": "kept.json", "save": "kept.contin"})
    assert call("run", path, "--quiet", "--json", FULL) == 1
    assert capsys.readouterr().err == "/dev/full: cannot be written (No space left on device)\n"
    assert FULL.is_char_device()  # written to, not replaced
    assert len(results(tmp_path / "kept.json")["branches"]) == 1
    assert call("export", tmp_path / "kept.contin", tmp_path / "again.json") == 0


@pytest.mark.seldom
def test_a_reader_that_has_seen_enough_loses_no_output(tmp_path):
    run_file(tmp_path, FOLD, {"parameter": "p"}, outputs={"json": "kept.json", "plot": "kept.png"})
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [*COMMAND, "run", "case.yaml"], cwd=tmp_path, stdout=writing, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, "standard output: the reader has gone (broken pipe)\n")
    assert len(results(tmp_path / "kept.json")["branches"]) == 1
    assert (tmp_path / "kept.png").stat().st_size > 1000


def test_links_are_followed_and_pipes_are_written_to(tmp_path):
    link, pipe = tmp_path / "link.json", tmp_path / "pipe"
    link.symlink_to("target.json")
    write_text(link, "one")
    assert link.is_symlink()
    assert (tmp_path / "target.json").read_text() == "one"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_text(pipe, "two")
    assert os.read(reader, 9) == b"two"
    os.close(reader)
    loop = tmp_path / "loop"
    loop.symlink_to("loop")
    with pytest.raises(InputError, match="loop"):
        write_text(loop, "three")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="the superuser may write everywhere")
def test_a_folder_that_may_not_be_written_to_is_found_before_the_computation(tmp_path, capsys):
    path = run_file(tmp_path, FOLD, {"parameter": "p"}, outputs={"save": "r.contin"})
    tmp_path.chmod(0o555)
    try:
        assert call("run", path) == 2
    finally:
        tmp_path.chmod(0o755)
    assert "may not be written to" in capsys.readouterr().err


SLOW = {"name": "a", "parameter": "p", "settings": {"max_step": 1e-6, "step": 1e-6, "steps": 10_000_000}}


@needs_fork
@pytest.mark.parametrize("resume", [[], ["--resume"]])
def test_a_store_that_another_process_writes_is_left_alone(tmp_path, resume):
    run_file(tmp_path, FOLD, SLOW, outputs={"save": "r.contin"})
    first = started(tmp_path, "run", "case.yaml", "-q", before=short_chunks)
    assert wait_for(lambda: kept(tmp_path / "r.contin") > 100_000, first)
    inode = (tmp_path / "r.contin").stat().st_ino
    assert finished(started(tmp_path, "run", "case.yaml", "-q", *resume)) == 2
    told = (tmp_path / "err").read_text()
    assert "r.contin: in use by another process; wait for it, or save under another name" in told
    assert (tmp_path / "r.contin").stat().st_ino == inode
    assert first.is_alive()
    first.kill()
    first.join()
