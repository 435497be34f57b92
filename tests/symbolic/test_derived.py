"""What is kept of a derivation is exactly what was derived, belongs to that model, and is never trusted."""

import json
import subprocess
import sys

import pytest

import contin
from contin.machine.folder import open_folder
from contin.symbolic.averaging import derived
from contin.symbolic.averaging.averaged import averaged


@pytest.fixture
def kept(tmp_path, monkeypatch):
    place = open_folder(tmp_path / "derived-models")
    monkeypatch.setattr(derived, "folder", lambda _: place)
    monkeypatch.setattr(derived, "WORTH_KEEPING", -1.0)
    return place


@pytest.mark.parametrize("form", ["polar", "cartesian", "stokes"])
def test_what_is_read_back_is_what_a_fresh_derivation_gives(kept, form):
    model = contin.load("metronomes/pair")
    fresh = averaged(model, form).model
    first, second = contin.average(model, form=form), contin.average(model, form=form)
    assert first == second == fresh
    assert len(kept.names()) == 1


def test_other_models_and_options_have_files_of_their_own(kept):
    model = contin.load("metronomes/pair")
    contin.average(model)
    contin.average(model, form="cartesian")
    contin.average(model, time="fast")
    other = model.replace(starts=model.starts[:1])
    assert contin.average(other).starts == averaged(other).model.starts
    assert len(kept.names()) == 4


@pytest.mark.parametrize("damage", [lambda b: b"", lambda b: b[:-1], lambda b: b[:200] + bytes([b[200] ^ 1]) + b[201:]])
def test_a_damaged_file_is_made_anew_with_a_note(kept, damage, capsys):
    model = contin.load("metronomes/pair")
    made = contin.average(model)
    (name,) = kept.names()
    whole = kept.read(name)
    kept.write(name, damage(whole))
    assert contin.average(model) == made
    assert "was damaged: it is made anew" in capsys.readouterr().err
    assert kept.read(name) == whole


def test_the_oldest_go_where_there_are_many(kept, monkeypatch):
    monkeypatch.setattr(derived, "MOST_FILES", 2)
    model = contin.load("metronomes/pair")
    for time in ("slow", "fast"):
        for form in ("polar", "stokes"):
            contin.average(model, form=form, time=time)
    assert len(kept.names()) == 2


def test_a_model_that_cannot_be_averaged_is_refused_every_time(kept):
    for _ in range(2):
        with pytest.raises(contin.InputError, match="form"):
            contin.average(contin.load("metronomes/pair"), form="round")


@pytest.mark.seldom
def test_a_second_run_writes_the_same_bytes_without_computer_algebra(tmp_path):
    """In processes of their own, with an empty folder; times apart."""
    text = (
        "contin: 1\nmodel: metronomes/pair\ntransform: [{average: {form: stokes}}]\nparameters: {beta: 0.8}\n"
        "continuations: [{name: line, start: in-phase, parameter: mu, range: [4, 8]}]\n"
    )
    (tmp_path / "run.yaml").write_text(text)
    results, loaded = [], []
    code = (
        "import sys; from pathlib import Path; from contin.machine import folder; real = folder.place\n"
        "own = {'derived-models': Path('derived').absolute()}\n"
        "folder.place = lambda name='machine-code': own.get(name) or real(name)\n"
        "from contin.cli.main import main\n"
        "try: main()\n"
        "finally: print('sympy' in sys.modules, file=sys.stderr)\n"
    )
    for _ in range(2):
        command = [sys.executable, "-c", code, "run", "run.yaml", "--json", "-", "--quiet"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True, timeout=300)
        document = json.loads(done.stdout)
        for key in ("timing", "sha256"):
            document.pop(key)
        for branch in document["branches"]:
            branch.pop("seconds", None)
        results.append(json.dumps(document))
        loaded.append(done.stderr.split()[-1])
    assert loaded == ["True", "False"]
    assert results[0] == results[1]
