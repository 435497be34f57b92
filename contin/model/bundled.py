"""Where the bundled models are: the repository's `models/`, or its copy `contin/_models` in an installed wheel."""

from __future__ import annotations

from pathlib import Path


def folder() -> Path:
    """The folder with one folder for each family of models.

    In a source tree (also an editable install) that is the repository's folder, so an edited file is seen at once and
    a copy left over from a build is not. Entry point of the group `contin.models`, like any plugin's.
    """
    package = Path(__file__).resolve().parent.parent
    repository = package.parent
    if (repository / "models").is_dir() and (repository / "pyproject.toml").is_file():
        return repository / "models"
    return package / "_models"


def model_file(name: str) -> Path | None:
    """The file of a bundled model by its name, with or without its family; None where there is none, or several."""
    family, _, own = name.rpartition("/")
    files = [path for path in sorted(folder().glob("*/*.yaml")) if path.stem == own]
    found = [path for path in files if family in ("", path.parent.name)]
    return found[0] if len(found) == 1 else None


def runs() -> dict[str, Path]:
    """The bundled run files by name: metronomes/pair-phase is models/metronomes/runs/pair-phase.yaml."""
    return {f"{path.parent.parent.name}/{path.stem}": path for path in sorted(folder().glob("*/runs/*.yaml"))}
