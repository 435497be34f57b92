"""`contin derive`: the averaged equations of a model, with their derivation."""

from __future__ import annotations

from pathlib import Path

import typer

from contin.errors import InputError
from contin.model.registry import load
from contin.symbolic.averaging.derivation import derive


def derive_model(
    reference: str, form: str, time: str, order: int, latex: Path | None, markdown: Path | None, save: Path | None
) -> int:
    """Print the derivation, or write it; exit code."""
    derivation = derive(load(reference), form, time, order)
    written = {latex: derivation.latex, markdown: derivation.markdown, save: derivation.model.text}
    files = {path: make for path, make in written.items() if path is not None}
    for path, make in files.items():
        write_text(path, make())
    if not files:
        typer.echo(derivation.text(), nl=False)
    return 0


def write_text(path: Path, text: str) -> None:
    """Write a file in or below the working folder, and say so."""
    if not path.resolve().is_relative_to(Path.cwd()):
        raise InputError(f"{path}: files are written in or below the working folder")
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
    typer.echo(f"wrote {path}", err=True)
