"""JSON schema of model files, for editors and other programs."""

from __future__ import annotations

from contin.model.schema import FORMAT_VERSION, ModelEntry
from contin.records import Fields


def model_schema() -> Fields:
    """JSON Schema (draft 2020-12) of a model file; names and formulas are checked only on loading.

    In a file `contin: 1` is required; a model inside a run file and a call from Python may leave it out.
    """
    schema = ModelEntry.model_json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": f"contin model file, format {FORMAT_VERSION}",
        "required": ["contin", *schema["required"]],
    }
