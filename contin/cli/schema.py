"""`contin schema`: JSON schemas of the files, for editors and other programs."""

from __future__ import annotations

import json

from contin.errors import InputError


def print_schema(what: str) -> int:
    """Print the schema of model files, run files, scan files or results."""
    if what == "model":
        from contin.model.json_schema import model_schema

        schema = model_schema()
    elif what == "run":
        from contin.runs.json_schema import run_schema

        schema = run_schema()
    elif what == "scan":
        from contin.runs.json_schema import scan_schema

        schema = scan_schema()
    elif what == "result":
        from contin.store.result_schema import RESULT_SCHEMA

        schema = RESULT_SCHEMA
    else:
        raise InputError(f"there is no schema {what!r}: write `contin schema` model, run, scan or result")
    print(json.dumps(schema, indent=2))
    return 0
