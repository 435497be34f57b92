"""JSON schema of the results: what every reader may rely on."""

from __future__ import annotations

from typing import Final

from contin.records import Fields

KINDS: Final = ["equilibrium", "fixed-point", "orbit", "bvp", "locus", "algebraic", "connection", "manifold", "torus"]
_NUMBER: Final = {"type": ["number", "null"]}  # null stands for NaN and infinity
_PAIRS: Final = {"type": "array", "items": {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2}}
_POINT_REFERENCE: Final = {
    "type": ["object", "null"],
    "required": ["branch", "label"],
    "properties": {"branch": {"type": "string"}, "label": {"type": "string"}},
}

POINT: Final[Fields] = {
    "type": "object",
    "required": ["label", "type", "index", "values", "residual", "error", "normal_form"],
    "oneOf": [{"required": ["eigenvalues"]}, {"required": ["multipliers"]}],
    "properties": {
        "label": {"type": "string", "pattern": "^[A-Z][A-Z0-9]*[0-9]+$"},
        "type": {"type": "string"},
        "index": {"type": "integer", "minimum": 0},
        "values": {"type": "object", "additionalProperties": {"type": ["number", "boolean", "null"]}},
        "residual": _NUMBER,
        "error": _NUMBER,
        "errors": {"type": "object", "additionalProperties": _NUMBER},
        "eigenvalues": _PAIRS,
        "multipliers": _PAIRS,
        "normal_form": {"type": "object"},
        "also": {"type": "string"},
        "orbit": {"type": "object", "required": ["t"]},
        "fields": {"type": "object", "additionalProperties": {"type": "array"}},
    },
}

BRANCH: Final[Fields] = {
    "type": "object",
    "required": [
        "name", "kind", "locus", "parameters", "parent", "image_of", "columns", "points", "ends", "steps", "seconds",
    ],
    "properties": {
        "name": {"type": "string"},
        "kind": {"enum": KINDS},
        "locus": {"type": ["string", "null"]},
        "parameters": {"type": "array", "items": {"type": "string"}, "minItems": 0, "maxItems": 3},
        "free": {"type": "array", "items": {"type": "string"}},
        "parent": _POINT_REFERENCE,
        "image_of": {"type": ["object", "null"], "required": ["branch", "symmetry"]},
        "columns": {
            "type": "object",
            "additionalProperties": {"type": "array", "items": {"type": ["number", "boolean", "null"]}},
        },
        "points": {"type": "array", "items": POINT},
        "ends": {
            "type": "array",
            "minItems": 2,
            "maxItems": 2,
            "items": {"type": "object", "required": ["reason", "text"]},
        },
        "steps": {"type": "integer", "minimum": 0},
        "seconds": {"type": "number", "minimum": 0},
        "effort": {"type": "object"},
        "rows": {
            "type": "object",
            "properties": {
                "start": {"type": "integer", "minimum": 0},
                "eigenvalues": {"type": "array", "items": _PAIRS},
                "orbits": {
                    "type": "array",
                    "items": {
                        "type": "object",
                        "required": ["row", "orbit"],
                        "properties": {
                            "row": {"type": "integer", "minimum": 0},
                            "orbit": {"type": "object", "required": ["t"], "additionalProperties": {"type": "array"}},
                        },
                    },
                },
            },
        },
    },
}  # fmt: skip

PHASE: Final[Fields] = {
    "type": "object",
    "required": ["parameters", "range", "curves", "regions", "borders"],
    "properties": {
        "parameters": {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2},
        "range": {"type": "object", "additionalProperties": {"type": "array", "items": _NUMBER}},
        "curves": {"type": "array", "items": {"type": "string"}},
        "regions": {
            "type": "array",
            "items": {
                "type": "object",
                "required": [
                    "name",
                    "number",
                    "words",
                    "stable",
                    "total",
                    "point",
                    "states",
                    "area",
                    "outline",
                    "holes",
                ],
                "properties": {
                    "name": {"type": "string"},
                    "number": {"type": "integer", "minimum": 0},
                    "words": {"type": "string"},
                    "stable": {"type": "integer", "minimum": 0},
                    "total": {"type": "integer", "minimum": 0},
                    "stable_orbits": {"type": "integer", "minimum": 0},
                    "orbits": {"type": "integer", "minimum": 0},
                    "aperiodic": {"type": "integer", "minimum": 0},
                    "point": {"type": "object", "additionalProperties": _NUMBER},
                    "states": {
                        "type": "array",
                        "items": {"type": "object", "required": ["values", "unstable", "stable", "copies"]},
                    },
                    "area": _NUMBER,
                    "outline": _PAIRS,
                    "holes": {"type": "array", "items": _PAIRS},
                },
            },
        },
        "notes": {"type": "array", "items": {"type": "string"}},
        "borders": {"type": "array", "items": {"type": "object", "required": ["regions", "curves"]}},
    },
}

_TABLE: Final = {"type": "object", "additionalProperties": {"type": "array"}}
SIMULATION: Final[Fields] = {
    "type": "object",
    "required": ["name", "model", "parameters", "outcome", "end_time", "columns"],
    "properties": {
        "name": {"type": "string"},
        "outcome": {"enum": ["done", "escaped", "sliding", "stopped"]},
        "end_time": _NUMBER,
        "columns": _TABLE,
        "section": _TABLE,  # the crossings of a Poincare section
        "lyapunov": {
            "type": "object",
            "required": ["exponents", "errors", "dimension", "time", "outcome"],
            "properties": {
                "exponents": {"type": "array", "items": _NUMBER}, "errors": {"type": "array", "items": _NUMBER},
                "dimension": _NUMBER, "time": _NUMBER, "outcome": {"type": "string"},
            },
        },
    },
}
SWEEP: Final[Fields] = {
    "type": "object",
    "required": ["parameter", "quantities", "columns"],
    "properties": {"parameter": {"type": "string"}, "quantities": {"type": "array"}, "columns": _TABLE},
}

RESULT_SCHEMA: Final[Fields] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "contin results, format 1",
    "type": "object",
    "required": ["contin", "model", "branches", "notes", "timing"],
    "properties": {
        "contin": {"const": 1},
        "model": {
            "type": "object",
            "required": ["name", "states", "parameters"],
            "properties": {
                "name": {"type": "string"},
                "states": {"type": "array", "items": {"type": "string"}},
                "parameters": {"type": "object", "additionalProperties": _NUMBER},
                "units": {"type": "object"},
                "periods": {"type": "object"},
            },
        },
        "branches": {"type": "array", "items": BRANCH},
        "diagram": {
            "type": "object",
            "required": ["parameter", "range", "branches"],
            "properties": {
                "parameter": {"type": "string"},
                "range": {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2},
                "branches": {"type": "array", "items": {"type": "string"}},
                "stopped": {"type": "boolean"},
                "unfinished": {"type": "array", "items": {"type": "string"}},
                "notes": {"type": "array", "items": {"type": "string"}},
            },
        },
        "phase": PHASE,
        "simulations": {"type": "array", "items": SIMULATION},
        "sweep": SWEEP,
        "notes": {"type": "array", "items": {"type": "string"}},
        "built": {
            "type": "object",
            "required": ["version", "target", "libraries"],
            "properties": {"libraries": {"enum": ["fixed", "by processor"]}},
            "additionalProperties": {"type": "string"},
        },
        "timing": {"type": "object", "required": ["total"], "additionalProperties": {"type": "number"}},
        "sha256": {"type": "string", "pattern": "^[0-9a-f]{64}$"},  # of the canonical text without it
    },
}
