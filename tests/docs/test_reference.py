"""Whatever users can reach has its place in the documentation."""

import re
from pathlib import Path

import contin
from contin.model import registry
from contin.special.table import table

DOCS = Path(__file__).resolve().parents[2] / "docs"


def page(name: str) -> str:
    return (DOCS / name).read_text("utf-8")


def test_every_public_name_stands_in_the_reference():
    documented = set(re.findall(r"contin\.(\w+)\b", page("reference.md")))
    assert {name for name in contin.__all__ if not name.startswith("__")} <= documented


def test_the_picture_of_the_readme_is_small_and_its_code_the_one_that_makes_it():
    readme = (DOCS.parent / "README.md").read_text("utf-8")
    [picture] = re.findall(r"!\[[^\]]+\]\((docs/[^)]+)\)", readme)
    assert 10_000 < (DOCS.parent / picture).stat().st_size < 100_000
    first = re.findall(r"^```python\n(.*?)^```$", readme, re.M | re.S)[0]
    script = page("readme_picture.py")
    for line in re.findall(r"^(?:neuron|rest|firing) = .*", first, re.M):
        assert line in script


def test_every_page_is_in_the_contents():
    contents = page("index.md") + page("gallery/index.md") + page("metronomes/index.md")
    pages = {path.stem for path in DOCS.rglob("*.md") if "_build" not in path.parts} - {"index"}
    assert {name for name in pages if not re.search(rf"\b{re.escape(name)}\b", contents)} == set()


def test_the_gallery_has_thirty_systems_with_their_models():
    shown = "".join(path.read_text("utf-8") for path in (DOCS / "gallery").glob("*.md"))
    models = set(re.findall(r"literalinclude\} \.\./\.\./models/(\S+)\.yaml", shown))
    assert len(models) >= 30
    for name in models:
        model = contin.load(name)
        assert model.source
        assert model.expect
    assert len(re.findall(r"^## ", shown, re.M)) == 38  # as its first sentence says
    bundled = {line.name for line in registry.listing() if line.source == "contin"}
    assert {name for name in bundled if name.startswith("classics/")} <= models


def test_the_table_of_labels_names_the_codes_of_other_programs():
    text = page("labels.md")
    ours = set(re.findall(r"\b[A-Z][A-Z0-9]{1,3}\b", " ".join(re.findall(r"^\| ([^|]*) \|", text, re.M))))
    assert {code for code, row in table().items() if row.codimension == 1} - {"HOM", "BE"} <= ours


def test_pages_name_commands_that_exist():
    """`contin.name(` in the pages is a public name; no page teaches what is not there."""
    named = set()
    for path in DOCS.glob("*.md"):
        for name in re.findall(r"(?<![\w.`])contin\.([a-z]\w*)\(", path.read_text("utf-8")):
            assert name in contin.__all__, f"{path.name}: contin.{name}"
            named.add(name)
    assert {"load", "continuation", "diagram"} <= named
