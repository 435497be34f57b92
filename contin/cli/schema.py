"""`contin schema`: JSON schemas of the files, for editors and other programs."""

from __future__ import annotations

import json

from contin.errors import InputError


def print_schema(what: str) -> int:
    """Print the schema of run files or of results."""
    from contin.runs.schema import RunEntry
    from contin.store.result_schema import RESULT_SCHEMA

    if what == "run":
        schema = {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            **RunEntry.model_json_schema(by_alias=True),
        }
    elif what == "scan":
        from contin.runs.scan_schema import ScanFileEntry

        schema = {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            **ScanFileEntry.model_json_schema(by_alias=True),
        }
    elif what == "result":
        schema = RESULT_SCHEMA
    else:
        raise InputError(f"there is no schema {what!r}: write `contin schema` run, scan or result")
    print(json.dumps(schema, indent=2))
    return 0
