"""Models by name: bundled ones and plugins through one mechanism, with failures kept to the plugin that has them."""

import importlib.metadata
import sys
import textwrap

import pytest

import contin
from contin.errors import InputError, ModelNotFoundError
from contin.model import bundled, registry
from contin.model.model import Model

MINE = "contin: 1\nname: {name}\ntitle: A plugin's model\nstates: {{x: 0}}\nequations: {{x: 1 - x}}\n"


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Puts a distribution with entry points and files on the path, as pip would."""

    def make(name, entry_points, files):
        site = tmp_path / name
        info = site / f"{name}-1.0.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        lines = "\n".join(f"{k} = {v}" for k, v in entry_points.items())
        (info / "entry_points.txt").write_text(f"[contin.models]\n{lines}\n")
        for path, text in files.items():
            target = site / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(textwrap.dedent(text))
        monkeypatch.syspath_prepend(str(site))
        importlib.invalidate_caches()
        modules = {path.split("/")[0].removesuffix(".py") for path in files}
        for module in modules:
            monkeypatch.delitem(sys.modules, module, raising=False)
        return site

    return make


@pytest.mark.parametrize(
    "name", ["metronomes/pair", "pair", "brusselator", "classics/lorenz", "lorenz", "co-oxidation"]
)
def test_bundled_models_resolve_with_and_without_their_family(name):
    assert contin.load(name).name == name.rpartition("/")[2]


def test_listing_has_names_titles_and_origin():
    lines = {line.name: (line.title, line.source) for line in registry.listing()}
    assert lines["classics/lorenz"] == ("The Lorenz equations", "contin")


def test_unknown_names_suggest_close_ones_and_a_path():
    with pytest.raises(ModelNotFoundError, match=r"'brusselater': did you mean .*brusselator.*\./brusselater\.yaml"):
        contin.load("brusselater")
    with pytest.raises(ModelNotFoundError, match=r"it is a family; its models are .*metronomes/pair-averaged, .*\."):
        contin.load("metronomes")
    with pytest.raises(ModelNotFoundError, match=r"no model file .*there is no folder"):
        contin.load("nowhere/m.yaml")


def test_a_path_is_relative_to_the_base_folder(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "mine.yaml").write_text(MINE.format(name="mine"))
    (tmp_path / "plain").write_text(MINE.format(name="plain"))
    assert registry.find("sub/mine.yaml", tmp_path).name == "mine"
    assert registry.find("plain", tmp_path).name == "plain"
    with pytest.raises(ModelNotFoundError, match=r"did you mean 'mine.yaml'"):
        registry.find("sub/mne.yaml", tmp_path)


def test_a_plugin_may_give_a_folder_a_model_a_function_or_a_module(install):
    install(
        "acme",
        {"acme": "acme_models", "acme-f": "acme_models.give:folder", "acme-m": "acme_models.give:MODEL",
         "acme-c": "acme_models.give:make"},
        {
            "acme_models/__init__.py": "",
            "acme_models/first.yaml": MINE.format(name="first"),
            "acme_models/deep/second.yaml": MINE.format(name="second"),
            "acme_models/third.py": '''
                """A family made by a program."""
                import contin
                def model():
                    return contin.Model("third", states={"x": 0}, equations={"x": "-x"})
                ''',
            "acme_models/_hidden.yaml": MINE.format(name="hidden"),
            "acme_models/give.py": '''
                from pathlib import Path
                import contin
                MODEL = contin.Model("made", states={"x": 0}, equations={"x": "-x"})
                def make():
                    return MODEL
                def folder():
                    return str(Path(__file__).parent)
                ''',
        },
    )  # fmt: skip
    assert contin.load("acme/first").name == "first"
    assert contin.load("acme/deep/second").name == "second"
    assert contin.load("acme/third").name == "third"
    assert contin.load("acme-f/first").name == "first"
    assert contin.load("acme-m") is contin.load("acme-c")
    assert contin.load("acme:acme/first").name == "first"
    for name in ("acme/hidden", "acme/_hidden", "acme/nothing", "acme/../acme_models/first"):
        with pytest.raises(ModelNotFoundError):
            contin.load(name)


def test_listing_and_other_models_do_not_import_a_plugin(install):
    install("lazy", {"lazy": "lazy_models:MODEL"}, {"lazy_models.py": "raise SystemError('imported')"})
    assert ("lazy", "", "lazy") in [tuple(line) for line in registry.listing()]
    contin.load("brusselator")
    assert "lazy_models" not in sys.modules


def test_a_broken_plugin_is_a_warning_that_names_its_package(install):
    install("broken", {"broken": "broken_models:MODEL"}, {"broken_models.py": "raise RuntimeError('sorry')"})
    with (
        pytest.warns(UserWarning, match="'broken' of the package broken cannot be loaded: RuntimeError: sorry"),
        pytest.raises(ModelNotFoundError),
    ):
        contin.load("broken")
    assert contin.load("lorenz").name == "lorenz"


def test_two_packages_with_one_name_are_both_named(install):
    code = "import contin\nMODEL = contin.Model('m', states={'x': 0}, equations={'x': '-x'})"
    install("one-shop", {"clash": "one_shop:MODEL"}, {"one_shop.py": code})
    install("two-shop", {"clash": "two_shop:MODEL", "brusselator": "two_shop:MODEL"}, {"two_shop.py": code})
    with pytest.raises(InputError, match="several models are called 'clash': one-shop:clash and two-shop:clash"):
        contin.load("clash")
    assert contin.load("two-shop:clash").name == "m"
    with pytest.raises(InputError, match="contin:classics/brusselator and two-shop:brusselator"):
        contin.load("brusselator")
    assert contin.load("classics/brusselator").name == "brusselator"


def test_plugins_can_be_switched_off(install, monkeypatch):
    code = "import contin\nMODEL = contin.Model('m', states={'x': 0}, equations={'x': '-x'})"
    install("off", {"off": "off_models:MODEL"}, {"off_models.py": code})
    monkeypatch.setenv("CONTIN_PLUGINS", "0")
    with pytest.raises(ModelNotFoundError):
        contin.load("off")
    assert {line.source for line in registry.listing()} == {"contin"}
    assert contin.load("lorenz").name == "lorenz"


def test_bundled_folder_is_the_repository_in_a_source_tree_and_the_copy_in_a_wheel(tmp_path, monkeypatch):
    fake = tmp_path / "site" / "contin" / "model" / "bundled.py"
    fake.parent.mkdir(parents=True)
    (tmp_path / "site" / "models").mkdir()  # a stranger's package called models
    monkeypatch.setattr(bundled, "__file__", str(fake))
    assert bundled.folder() == tmp_path / "site" / "contin" / "_models"
    (tmp_path / "site" / "pyproject.toml").write_text("")
    assert bundled.folder() == tmp_path / "site" / "models"


def test_import_is_light():
    import subprocess

    heavy = "('numpy', 'sympy', 'pydantic', 'ruamel.yaml', 'numba')"
    code = f"import contin, sys; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_exports_are_lazy_and_complete():
    assert contin.Model is Model
    assert set(contin.__all__) <= set(dir(contin))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        contin.nothing  # noqa: B018
