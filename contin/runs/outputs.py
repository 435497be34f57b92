"""Where a run file may write: in or below its own folder, nowhere else."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Final

from contin.errors import InputError
from contin.model.source import Path as Place
from contin.model.source import Problems
from contin.records import Json
from contin.runs.references import is_stored

ENDINGS: Final[dict[str, tuple[str, ...]]] = {
    "plot": (".png", ".pdf", ".svg"),
    "html": (".html",),
    "save": (".contin",),
    "json": (".json",),
    "csv": (".csv",),
}


def output_paths(
    written: Mapping[str, str], run_file: Path, problems: Problems, endings: Mapping[str, tuple[str, ...]] = ENDINGS
) -> dict[str, Path]:
    """The files to write, by kind; what may not be written is noted in `problems` and left out.

    A path must be relative, without '..', must not lead out of the run file's folder through a symbolic link, must have
    an ending of its kind, and must not be the run file itself.
    """
    taken: list[Path] = []
    found = {
        kind: output_path(text, kind, run_file, problems, taken, ("outputs", kind), endings)
        for kind, text in written.items()
    }
    return {kind: path for kind, path in found.items() if path is not None}


def output_path(
    text: str,
    kind: str,
    run_file: Path,
    problems: Problems,
    taken: list[Path],
    place: Place,
    endings: Mapping[str, tuple[str, ...]] = ENDINGS,
) -> Path | None:
    """One file to write, added to those `taken`; None, with a note at `place`, where it may not be written."""
    folder = run_file.parent.resolve()
    mistake = path_mistake(text, endings[kind], folder, run_file)
    path = folder / PurePosixPath(text)
    if not mistake and path in taken:
        mistake = f"{text!r} is already written by another output; choose another name"
    if mistake:
        problems.add(place, mistake)
        return None
    taken.append(path)
    return path


def path_mistake(text: str, endings: tuple[str, ...], folder: Path, run_file: Path) -> str | None:
    """What is wrong with a file's name that must stay in or below `folder`; None where nothing is."""
    if any(ord(character) < 32 for character in text):
        return "a file name may not contain control characters"
    parts = (PurePosixPath(text), PureWindowsPath(text))  # the same files are refused on every system
    if any(path.is_absolute() or path.drive or path.root for path in parts):
        return f"must be relative to this file's folder, got {text!r}; write a name such as {parts[1].name!r}"
    if any(".." in path.parts for path in parts):
        return f"must stay in or below this file's folder, got {text!r}"
    if PurePosixPath(text).suffix.lower() not in endings:
        return f"must end in {' or '.join(endings)}, got {text!r}"
    path = folder / PurePosixPath(text)
    try:
        real = path.resolve()
    except (OSError, RuntimeError):
        return f"leads nowhere: {text!r} is a loop of symbolic links"
    if not real.is_relative_to(folder):
        return f"must stay in or below this file's folder; {text!r} leads out of it through a symbolic link"
    if real == run_file.resolve():
        return f"would overwrite the run file itself: {text!r}"
    if path.is_dir():
        return f"{text!r} is a folder; name a file"
    return None


def files_read(entry: Json, run_file: Path) -> list[Path]:
    """The files that a run or scan file is made of: itself, a model, samples, results. No output may overwrite them."""
    samples = [item.samples for item in getattr(entry, "continuations", ()) if item.samples is not None]
    starts = [item.from_ for item in getattr(entry, "continuations", ()) if item.from_ and is_stored(item.from_)]
    samples += [text.partition(".contin:")[0] + ".contin" for text in starts]
    models = [entry.model] if isinstance(entry.model, str) else []
    named = [run_file.parent / Path(text).expanduser() for text in (*models, *samples)]
    return [run_file, *(path for path in named if path.is_file())]


def make_folder(path: Path) -> None:
    """Make the folder of an output below the run file's, where it is missing; InputError where it cannot be."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: its folder cannot be made ({error.strerror})") from None
