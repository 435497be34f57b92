"""Run files by name: a path, or one of those that come with contin."""

from __future__ import annotations

from pathlib import Path

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.bundled import runs
from contin.model.source import Problems
from contin.model.yaml_reader import read_file


def find_run(reference: Path) -> tuple[Path, Path]:
    """The file to read, and the file it counts as: its outputs go into that one's folder.

    A path counts as itself. A bundled run (metronomes/pair-phase, or pair-phase where one family has it) counts as a
    file of its name in the current folder.

    Raises InputError where neither a file nor a bundled run has the name.
    """
    text = reference.as_posix()
    if reference.exists() or reference.suffix.lower() in (".yaml", ".yml", ".json") or reference.is_absolute():
        return reference, reference
    known = runs()
    names = [name for name in known if text in (name, name.rpartition("/")[2])]
    if len(names) == 1:
        return known[names[0]], Path.cwd() / f"{names[0].rpartition('/')[2]}.yaml"
    if names:
        raise InputError(f"several bundled runs are called {text!r}: {' and '.join(names)}")
    advice = closest(text, list(known)) or closest(text, [name.rpartition("/")[2] for name in known])
    raise InputError(
        f"no run file and no bundled run is called {text!r}: {advice or '`contin models` lists the bundled runs.'}"
    )


def is_scan(file: Path) -> bool:
    """True for a file with `scan:`; raises InputError for a file that cannot be read, or that wants both."""
    document = read_file(file)
    if not isinstance(document.data, dict) or "scan" not in document.data:
        return False
    problems = Problems(document.source)
    for key in ("continuations", "diagram", "phase", "simulate", "sweep"):
        if key in document.data:
            problems.add((key,), f"a file with `scan:` has no `{key}:`; write a file for each", key=True)
    problems.raise_if_any()
    return True
