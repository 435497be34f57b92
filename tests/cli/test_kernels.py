"""`contin kernels`: what is there, where, made, and cleared."""

import pytest

from contin.machine import folder as module
from contin.machine import target
from tests.cli.calls import call


def test_status_names_the_target_and_counts(capsys):
    assert call("kernels") == 0
    told = capsys.readouterr().out
    assert target.label() in told
    assert "came with contin" in told


def test_where_and_clear_use_the_chosen_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("CONTIN_CACHE_DIR", str(tmp_path))
    module.folder.cache_clear()
    try:
        assert call("kernels", "where") == 0
        assert str(tmp_path / "machine-code") in capsys.readouterr().out
        (tmp_path / "machine-code" / "some.kernel-0").write_bytes(b"anything")
        assert call("kernels", "clear") == 0
        assert "removed 1 files" in capsys.readouterr().out
        assert list((tmp_path / "machine-code").iterdir()) == []
    finally:
        module.folder.cache_clear()


@pytest.mark.parametrize("word", ["made", ""])
def test_other_words_are_refused_with_those_that_are_known(word, capsys):
    assert call("kernels", word) == 2
    assert "status, build, clear, where" in capsys.readouterr().err
