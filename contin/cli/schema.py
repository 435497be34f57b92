"""`contin schema`: JSON schemas of the files, for editors and other programs."""

from __future__ import annotations

import json

from contin.errors import InputError
from contin.model.json_schema import model_schema
from contin.pde.schema import pde_schema
from contin.runs.json_schema import run_schema, scan_schema
from contin.store.result_schema import RESULT_SCHEMA


def print_schema(what: str) -> int:
    """Print the schema of model files (also of kind: pde), run files, scan files or results."""
    if what == "model":
        schema = model_schema()
    elif what == "pde":
        schema = pde_schema()
    elif what == "run":
        schema = run_schema()
    elif what == "scan":
        schema = scan_schema()
    elif what == "result":
        schema = RESULT_SCHEMA
    else:
        raise InputError(f"there is no schema {what!r}: write `contin schema` model, pde, run, scan or result")
    print(json.dumps(schema, indent=2))
    return 0
