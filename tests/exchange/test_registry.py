"""Foreign files are read by their ending, wherever a model may be named."""

import sys
import types
from pathlib import Path

import pytest

from contin.cli.main import main
from contin.errors import InputError, InputWarning, ModelNotFoundError
from contin.exchange import registry, xml_text
from contin.exchange.imported import Exported, Imported, UnsupportedError
from contin.model.printing import to_text
from contin.model.registry import load

DECAY = {"name": "decay", "states": {"x": 1}, "parameters": {"k": 2}, "equations": {"x": "-k*x"}}


def read_decay(text: str, path: Path) -> Imported:
    if "delay" in text:
        raise UnsupportedError(f"{path}: line 1: delays are not supported")
    return Imported({**DECAY, "name": path.stem}, ("units are not read",), {"simulate": [{"time": 1.0}]})


def write_decay(model) -> Exported:
    return Exported(f"x' = {to_text(model.equations[0])}\n", ("nothing is lost",))


@pytest.fixture
def decay(monkeypatch, tmp_path):
    module = types.ModuleType("decay_format")
    module.read, module.write = read_decay, write_decay
    monkeypatch.setitem(sys.modules, "decay_format", module)
    monkeypatch.setitem(registry.READERS, ".dcy", "decay_format:read")
    monkeypatch.setitem(registry.WRITERS, ".dcy", "decay_format:write")
    file = tmp_path / "slow.dcy"
    file.write_text("decay")
    return file


def run(*arguments) -> int:
    with pytest.raises(SystemExit) as end:
        main([str(a) for a in arguments])
    return int(end.value.code or 0)


def test_a_foreign_file_is_a_model_by_its_path(decay):
    with pytest.warns(InputWarning, match="units are not read"):
        model = load(str(decay))
    assert model.name == "slow"
    assert model.equations == load({**DECAY}).equations


def test_import_writes_a_model_file_and_its_notes(decay, tmp_path, capsys):
    out = tmp_path / "slow.yaml"
    assert run("import", decay, "-o", out) == 0
    assert "note: units are not read" in capsys.readouterr().err
    assert load(str(out)).equations == load({**DECAY}).equations
    assert run("import", decay) == 0
    assert capsys.readouterr().out == out.read_text()


def test_what_is_not_supported_is_named_with_exit_code_2(decay, capsys):
    decay.write_text("delay")
    assert run("import", decay) == 2
    assert "line 1: delays are not supported" in capsys.readouterr().err


@pytest.mark.filterwarnings("ignore::contin.errors.InputWarning")
def test_commands_take_foreign_files(decay, tmp_path, capsys):
    assert run("check", decay) == 0
    assert run("simulate", decay, "--time", "1", "--samples", "2", "--csv", tmp_path / "x.csv") == 0
    assert float((tmp_path / "x.csv").read_text().split()[-1].split(",")[1]) == pytest.approx(0.1353352832366127)
    assert run("run", decay, "-q") == 0
    assert run("export", decay, tmp_path / "other.dcy") == 0
    assert (tmp_path / "other.dcy").read_text() == "x' = -k*x\n"
    file = tmp_path / "run.yaml"
    file.write_text("contin: 1\nmodel: slow.dcy\nsimulate: [{time: 1}]\n")
    assert run("run", file, "-q") == 0


def test_unknown_and_missing_files(tmp_path):
    with pytest.raises(InputError, match=r"end in \.doc cannot be read; known endings: "):
        registry.read(tmp_path / "a.doc")
    with pytest.raises(ModelNotFoundError, match="no file"):
        registry.read(tmp_path / "a.xml")


def test_xml_with_entities_is_refused(tmp_path):
    file = tmp_path / "a.xml"
    file.write_text('<?xml version="1.0"?><!-- x --><!DOCTYPE a [<!ENTITY b "c">]><sbml/>')
    with pytest.raises(InputError, match="document type declaration"):
        registry.read(file)
    assert xml_text.root("<?xml version='1.0'?>\n<!-- <a> --><s:sbml level='3'/>", file) == "sbml"
    file.write_text("<html></html>")
    with pytest.raises(InputError, match="root element is <html>"):
        registry.read(file)


def test_texts_of_any_coding_are_read():
    assert registry.decoded("\N{GREEK SMALL LETTER MU}".encode("utf-16")) == "\N{GREEK SMALL LETTER MU}"
    assert registry.decoded("\N{MICRO SIGN}".encode("latin-1")) == "\N{MICRO SIGN}"
