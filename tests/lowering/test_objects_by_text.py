"""Object files of models are kept by their text, read back as they were made, and never trusted blindly."""

import numpy as np
import pytest

from contin.lowering import compile_system, objects_by_text
from contin.machine.folder import open_folder
from contin.model.model import Model


@pytest.fixture
def kept(tmp_path, monkeypatch):
    place = open_folder(tmp_path / "compiled-models")
    monkeypatch.setattr(objects_by_text, "folder", lambda _: place)
    monkeypatch.setattr(objects_by_text, "WORTH_KEEPING", -1.0)
    monkeypatch.setattr(objects_by_text, "_known", type(objects_by_text._known)())
    return place


def values(factor=1.0):
    model = Model(
        "m", states={"x": 0.3, "y": 0.2}, parameters={"a": 0.7},
        equations={"x": f"{factor}*exp(a*x)*sin(y) - x^3", "y": "log(2 + x*y)/a"},
    )  # fmt: skip
    system = compile_system(model)
    u, p = model.start_point()
    return np.concatenate([part.ravel() for part in system.jacobian(u, p)])


def forget():
    objects_by_text._known.clear()


def test_bits_do_not_depend_on_whether_code_was_kept(kept):
    made = values()
    assert np.array_equal(values(), made)  # from this process
    forget()
    assert np.array_equal(values(), made)  # from the folder
    assert not np.array_equal(values(1.5), made)
    x, y, a = 0.3, 0.2, 0.7
    np.testing.assert_allclose(made[:2], [np.exp(a * x) * np.sin(y) - x**3, np.log(2 + x * y) / a], rtol=1e-14)


@pytest.mark.parametrize("damage", [lambda b: b"", lambda b: b[:-1], lambda b: b[:99] + bytes([b[99] ^ 4]) + b[100:]])
def test_a_damaged_file_is_made_anew_with_a_note(kept, damage, capsys):
    made = values()
    whole = {name: kept.read(name) for name in kept.names()}
    for name, data in whole.items():
        kept.write(name, damage(data))
    forget()
    assert np.array_equal(values(), made)
    assert capsys.readouterr().err.count("was damaged: it is made anew") == len(whole)
    assert {name: kept.read(name) for name in kept.names()} == whole


def test_a_file_of_another_model_is_not_taken_for_it(kept, capsys):
    values(1.5)
    others = [kept.read(name) for name in kept.names()]
    made = values()
    for name in kept.names():
        kept.write(name, others[0])
    forget()
    assert np.array_equal(values(), made)


def test_few_are_kept_in_memory_and_on_disk(kept, monkeypatch):
    monkeypatch.setattr(objects_by_text, "MOST", 3)
    monkeypatch.setattr(objects_by_text, "MOST_FILES", 4)
    monkeypatch.setattr(objects_by_text, "EVERY", 1)
    monkeypatch.setattr(objects_by_text, "_written", 0)
    for k in range(8):
        objects_by_text.object_of(f"text {k}", 2, lambda: b"code")
    assert len(objects_by_text._known) == 3
    assert len(kept.names()) == 4
