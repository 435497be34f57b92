"""Standard output that takes nothing, full disks, files in the way: every other output is written, in whole."""

import json
import os
import resource
import shutil
import subprocess
from pathlib import Path

import pytest

from contin.store.results import read_results
from contin.store.verify import verify
from tests.cli.calls import FOLD, call, run_file
from tests.faults.processes import finished, needs_fork, started

pytestmark = needs_fork
TITLED = FOLD | {"title": "Fold \u2192 \u03bb \u00fc \u00e9"}
LINE = {"name": "a", "parameter": "p"}
OUTPUTS = {"plot": "r.png", "html": "r.html", "save": "r.contin", "json": "r.json"}
SCANNED = {"contin": 1, "name": "damped", "title": "\u2192 \u00e9", "states": {"x": 1}, "parameters": {"d": 1},
           "equations": {"x": "-d*x"}}  # fmt: skip
SCAN = {"axes": {"d": [0.5, 1, 2]}, "classes": {"rest": "x_max < 1e-3"}, "settle": {"window": 30}}
SCAN_OUTPUTS = {"csv": "s.csv", "plot": "s.png", "json": "s.json", "save": "s.scan"}


def long(*values):
    return [pytest.param(value, marks=pytest.mark.long) for value in values]


@pytest.fixture(scope="module", autouse=True)
def _warm():
    from tests.warm import warm_up

    warm_up()


def written(folder: Path, outputs: dict[str, str]) -> None:
    """Every output is there and whole."""
    for kind, name in outputs.items():
        assert (folder / name).stat().st_size > 100, name
        if kind in ("save", "json"):
            verify(folder / name)


def broken_pipe() -> int:
    reading, writing = os.pipe()
    os.close(reading)
    return writing


def out_of(kind: str) -> int | None:
    return {"closed": lambda: None, "pipe": broken_pipe, "full": lambda: os.open("/dev/full", os.O_WRONLY)}[kind]()


@pytest.mark.parametrize("what", ["run", "scan"])
@pytest.mark.parametrize(
    ("kind", "words"),
    [("closed", "closed"), ("pipe", "the reader has gone (broken pipe)"), ("full", "No space left on device")],
)
def test_standard_output_that_takes_nothing_is_named_and_costs_nothing_else(tmp_path, what, kind, words):
    if kind == "full" and not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    outputs = OUTPUTS if what == "run" else SCAN_OUTPUTS
    if what == "run":
        run_file(tmp_path, TITLED, LINE, outputs=outputs)
    else:
        run_file(tmp_path, SCANNED, scan=SCAN, outputs=outputs)
    assert finished(started(tmp_path, "run", "case.yaml", out=out_of(kind))) == 1
    assert (tmp_path / "err").read_text() == f"standard output: {words}\n"
    written(tmp_path, outputs)


@pytest.mark.parametrize("encoding", ["cp1252", *long("ascii", "cp437", "latin-1", "utf-16")])
def test_an_encoding_without_the_characters_gets_their_escapes(tmp_path, encoding):
    run_file(tmp_path, TITLED, LINE, outputs=OUTPUTS)
    assert finished(started(tmp_path, "run", "case.yaml", "--json", "-", encoding=encoding)) == 0
    document = json.loads((tmp_path / "out").read_text(encoding=encoding))
    assert document["model"]["title"] == TITLED["title"]
    written(tmp_path, OUTPUTS)
    assert finished(started(tmp_path, "run", "case.yaml", encoding=encoding)) == 0
    assert "wrote r.html" in (tmp_path / "out").read_text(encoding=encoding)


@pytest.mark.parametrize("limit", [600, 20_000, *long(0, 5_000, 10_000, 30_000, 40_000)])
def test_files_that_do_not_fit_leave_the_earlier_ones_whole(tmp_path, limit):
    def quota():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    run_file(tmp_path, FOLD, LINE, {"name": "b", "parameter": "p"}, outputs=OUTPUTS)
    assert finished(started(tmp_path, "run", "case.yaml", "-q")) == 0
    before = {name: (tmp_path / name).read_bytes() for name in OUTPUTS.values()}
    run_file(tmp_path, FOLD, LINE, outputs=OUTPUTS)
    code = finished(started(tmp_path, "run", "case.yaml", "-q", before=quota))
    assert code in (1, 2)
    words = (tmp_path / "err").read_bytes()  # words do not fit either where nothing does
    for kind, name in OUTPUTS.items():
        now = (tmp_path / name).read_bytes()
        if now == before[name]:
            assert name.encode() in words or limit < 600 or code == 2, (name, words)
        elif kind in ("save", "json"):
            assert [b["name"] for b in read_results(tmp_path / name)["branches"]] == ["a"]
    assert not list(tmp_path.glob(".*.part"))


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="mounts a small disk")
@pytest.mark.parametrize("size", ["64k", *long("8k", "16k", "32k", "96k", "128k", "192k", "256k")])
def test_a_small_disk_that_is_full_costs_only_what_does_not_fit(tmp_path, size):
    disk = tmp_path / "disk"
    disk.mkdir()
    if (
        shutil.which("mount") is None
        or subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(disk)], capture_output=True, check=False
        ).returncode
    ):
        pytest.skip("no mount")
    try:
        outputs = {kind: f"disk/{name}" for kind, name in OUTPUTS.items()} | {"plot": "r.png"}
        run_file(tmp_path, FOLD, LINE, outputs=outputs)
        code = finished(started(tmp_path, "run", "case.yaml", "-q", "--json", "whole.json"))
        words = (tmp_path / "err").read_text()
        assert code in (0, 1, 2)
        if code < 2:  # 2: not even the store could be begun, and nothing was computed
            verify(tmp_path / "whole.json")
            assert (tmp_path / "r.png").stat().st_size > 100
            for name in ("r.html", "r.contin", "r.json"):
                assert (disk / name).exists() or name in words
                assert code == 1 or (disk / name).exists()
        else:
            assert "full" in words or "cannot be written" in words
    finally:
        subprocess.run(["umount", "-l", str(disk)], check=False)


@pytest.mark.parametrize("kind", ["save", "json"])
def test_a_file_that_contin_did_not_write_is_left_as_it_is(tmp_path, capsys, kind):
    target = tmp_path / OUTPUTS[kind]
    target.write_text('{"precious": 1}')
    path = run_file(tmp_path, FOLD, LINE, outputs={kind: OUTPUTS[kind]})
    assert call("run", path) == 2
    assert "is no result of contin, and is not overwritten" in capsys.readouterr().err
    assert target.read_text() == '{"precious": 1}'


def test_no_output_overwrites_what_the_run_reads(tmp_path, capsys):
    (tmp_path / "model.json").write_text(json.dumps(FOLD))
    (tmp_path / "link.json").symlink_to("model.json")
    path = run_file(tmp_path, "model.json", LINE, name="case.json")
    for arguments in (["--json", tmp_path / "model.json"], ["--json", path], ["--json", tmp_path / "link.json"]):
        assert call("run", path, *arguments) == 2
        assert "which this run reads" in capsys.readouterr().err
    for name in ("model.json", "link.json"):
        run_file(tmp_path, "model.json", LINE, outputs={"json": name})
        for command in ("check", "run"):
            assert call(command, tmp_path / "case.yaml") == 2
    assert json.loads((tmp_path / "model.json").read_text()) == FOLD
    times = range(9)
    table = "t,x\n" + "".join(f"{t},{1 if t in (0, 8) else t}\n" for t in times)
    (tmp_path / "samples.csv").write_text(table)
    run_file(
        tmp_path, FOLD, {"name": "o", "samples": "samples.csv", "parameter": "p"}, simulate=[{"csv": "samples.csv"}]
    )
    assert call("run", tmp_path / "case.yaml") == 2
    assert (tmp_path / "samples.csv").read_text() == table
