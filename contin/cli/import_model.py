"""`contin import`: a foreign model as a model file."""

from __future__ import annotations

import sys
from pathlib import Path

import typer

from contin.cli.printable import printable
from contin.errors import InputError
from contin.exchange import registry
from contin.store.atomic import write_text


def import_model(file: Path, out: Path | None) -> int:
    """Read a foreign file, write it as YAML to `out` or to standard output; notes go to standard error."""
    if out is not None and out.suffix.lower() not in registry.OWN:
        raise InputError(f"{out}: a model file ends in {', '.join(registry.OWN[:2])}")
    found = registry.read(file)
    text = registry.model_of(found, file).text()
    for note in found.notes:
        sys.stderr.write(printable(f"note: {note}") + "\n")
    if out is None:
        typer.echo(text.rstrip("\n"))
    else:
        write_text(out, text)
    return 0
