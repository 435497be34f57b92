"""The drawing of the house is true to the tree: what it names is there, and what is there is named."""

import re
from pathlib import Path

import contin

ROOM = Path(contin.__file__).parent
ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs" / "architecture.md").read_text("utf-8")


def test_every_file_and_folder_that_the_drawing_names_is_there():
    whole = {
        path.relative_to(ROOT).as_posix() for top in ("contin", "docs", "tests") for path in (ROOT / top).rglob("*")
    }
    named = {name.rstrip("/") for name in re.findall(r"`([a-z_A-Z0-9]+(?:/[a-z_A-Z0-9]+)*(?:/|\.py|\.md))`", TEXT)}
    assert len(named) > 60
    assert {name for name in named if not any(path == name or path.endswith(f"/{name}") for path in whole)} == set()


def test_every_room_is_drawn():
    drawn = TEXT[TEXT.index("## The house") : TEXT.index("| room | holds")]
    rooms = {path.name for path in ROOM.iterdir() if (path / "__init__.py").is_file()}
    assert {room for room in rooms if f"{room}/" not in drawn} == set()
    parts = {path.name for path in (ROOM / "problems").iterdir() if (path / "__init__.py").is_file()}
    assert {part for part in parts if f"{part}/" not in drawn} == set()
