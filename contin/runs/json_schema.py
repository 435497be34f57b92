"""JSON schemas of run files and scan files, for editors and other programs."""

from __future__ import annotations

from pydantic import BaseModel

from contin.model.schema import FORMAT_VERSION
from contin.records import Fields
from contin.runs.scan_schema import ScanFileEntry
from contin.runs.schema import RunEntry


def run_schema() -> Fields:
    """JSON Schema (draft 2020-12) of a run file; whether names are declared is checked only on loading."""
    return _schema(RunEntry, "run")


def scan_schema() -> Fields:
    """JSON Schema (draft 2020-12) of a scan file."""
    return _schema(ScanFileEntry, "scan")


def _schema(entry: type[BaseModel], kind: str) -> Fields:
    schema = entry.model_json_schema(by_alias=True)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": f"contin {kind} file, format {FORMAT_VERSION}",
        "required": ["contin", *schema["required"]],
    }
