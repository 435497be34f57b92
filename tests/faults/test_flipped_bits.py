"""One bit of a stored file is turned over: what is read is what was written, or less of it, with words."""

import random
import shutil
import warnings
from contextlib import closing
from pathlib import Path

import pytest

from contin.continuation.sample import Chunk
from contin.errors import InputError
from contin.simulate.scan.grid import Outcome
from contin.store import json_format, sqlite
from contin.store.digest import DamageWarning
from contin.store.journal import SqliteJournal
from contin.store.scan_store import ScanStore, read_scan
from tests.plot.sample import bautin, pitchfork
from tests.store.test_journal import chunk

SHORT, LONG = 400, 20_000
trials = pytest.mark.parametrize("count", [SHORT, pytest.param(LONG, marks=pytest.mark.long)])


def flips(path: Path, count: int):
    """`count` damaged copies of a file, one bit each: (number, what is read there is up to the caller)."""
    whole = path.read_bytes()
    generator = random.Random(count)
    for bit in generator.sample(range(8 * len(whole)), min(count, 8 * len(whole))):
        damaged = bytearray(whole)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        yield bit
    path.write_bytes(whole)


def read(reader, path):
    """What a reader gives: (result or None, words of warnings or of the error)."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            found = reader(path)
        except InputError as error:
            return None, str(error)
    return found, " ".join(str(w.message) for w in told if issubclass(w.category, DamageWarning))


def document():
    model = {"name": "m", "states": ["x"], "parameters": {"p": 1.0}}
    return json_format.result_document(model, [*pitchfork(), *bautin()], timing={"total": 1.0}, notes=["a note"])


def without_notes(found):
    return {key: value for key, value in found.items() if key not in ("notes", "branches")}


@trials
def test_a_finished_store_is_never_read_as_another_result(tmp_path, count):
    path, made = tmp_path / "r.contin", document()
    sqlite.save(made, path, {"model_text": "text", "run": "run", "versions": "1"})
    noticed = 0
    for bit in flips(path, count):
        found, words = read(sqlite.load, path)
        if found is None:
            noticed += 1
            continue
        assert found == made or words, bit
        assert all(branch in made["branches"] for branch in found["branches"]), bit
        for key, value in without_notes(found).items():
            assert value == made[key] or (key == "timing" and words), (bit, key)
        noticed += bool(words)
    assert noticed > 0.2 * count  # the rest of the bits are in space that no row uses


@trials
def test_json_is_never_read_as_another_result_without_a_warning(tmp_path, count):
    path, made = tmp_path / "r.json", document()
    json_format.write(made, path)
    for bit in flips(path, count):
        found, words = read(json_format.read, path)
        assert found is None or found == made or "sha256" in words, bit


@trials
def test_an_unfinished_run_goes_on_from_chunks_as_they_were_computed(tmp_path, count):
    path, original = tmp_path / "r.contin", tmp_path / "original"
    journal = SqliteJournal(path, "mark", False, {"name": "m", "states": ["x"], "parameters": {}})
    chunks = [chunk(3 + k) for k in range(12)]
    for number, one in enumerate(chunks):
        journal.record("a:1" if number < 7 else "b:1", number if number < 7 else number - 7, one)
    journal.finished(pitchfork()[0])
    journal.close()
    shutil.copy(path, original)
    cut = 0
    for bit in flips(original, count):
        for file in (path, Path(f"{path}.unfinished")):
            file.unlink(missing_ok=True)
        shutil.copy(original, path)
        try:
            with closing(SqliteJournal(path, "mark", True)) as again:
                kept = [again.replay("a:1" if n < 7 else "b:1", n if n < 7 else n - 7) for n in range(len(chunks))]
                whole = next((n for n, one in enumerate(kept) if one is None), len(chunks))
                assert all(one is None for one in kept[whole:]), bit
                for one, expected in zip(kept[:whole], chunks, strict=False):
                    assert same(one, expected), bit
                assert whole == len(chunks) or again.notes, bit
                cut += whole < len(chunks)
        except InputError:
            cut += 1
    assert cut > 0.2 * count


def same(one: Chunk, other: Chunk) -> bool:
    arrays = ("z", "tangents", "tests", "unstable", "eigenvalues", "lengths")
    scalars = ("stop", "next_step", "reference", "dipped", "evaluations", "detail")
    return all(getattr(one, n).tobytes() == getattr(other, n).tobytes() for n in arrays) and all(
        getattr(one, n) == getattr(other, n) for n in scalars
    )


HEAD = {
    "contin": 1, "model": {"name": "m", "title": None, "states": ["x"], "parameters": {}},
    "scan": {"axes": {"p": [float(k) for k in range(40)]}, "starts": ["default"], "quantities": ["x"], "classes": {},
             "settle": {}},
}  # fmt: skip
ROWS = {job: Outcome("other", "settled", 1.0 + job, {"x_min": 0.1 * job, "x_max": float("nan")}) for job in range(40)}


@trials
def test_a_scan_is_read_and_resumed_without_its_damaged_runs(tmp_path, count):
    path, original = tmp_path / "r.scan", tmp_path / "original"
    store = ScanStore(path, "mark", HEAD, False)
    for job, outcome in ROWS.items():
        store.add(job, outcome)
    store.close()
    shutil.copy(path, original)
    complete = read_scan(path)["columns"]
    lines = set(zip(*map(texts, complete.values()), strict=True))
    for bit in flips(original, count // 4):  # slow: what is damaged is written anew, to the disk
        for file in (path, Path(f"{path}.unfinished")):
            file.unlink(missing_ok=True)
        shutil.copy(original, path)
        found, words = read(read_scan, path)
        if found is not None:
            assert set(zip(*map(texts, found["columns"].values()), strict=True)) <= lines, bit
            assert texts(found["columns"]["p"]) == texts(complete["p"]) or words, bit
        try:
            resumed = ScanStore(path, "mark", HEAD, True)
        except InputError:
            continue
        assert {job: repr(row) for job, row in resumed.rows.items()}.items() <= {
            job: repr(row) for job, row in ROWS.items()
        }.items(), bit
        assert len(resumed.rows) == len(ROWS) or resumed.notes, bit
        resumed.close()


def texts(column):
    return [repr(value) for value in column]
