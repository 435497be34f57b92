"""SHA-256 checksums: of a JSON document's canonical text, and of the parts of a store.

Canonical text: JSON with sorted keys, without spaces, every character as itself, numbers in the shortest form that
reads back equal (Python's `json.dumps(..., sort_keys=True, separators=(",", ":"), ensure_ascii=False)`), in UTF-8. So
the checksum of a document does not depend on how its text is laid out.
"""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from contin.records import Fields, Record

KEY: Final = "sha256"
ENCODER: Final = json.JSONEncoder(sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


NO_CHECKSUMS: Final = "has no checksums: written by an earlier contin; damage cannot be told"


class DamageWarning(UserWarning):
    """Something stored does not have the checksum it was written with, or has none."""


class LeftOutWarning(DamageWarning):
    """Damaged parts of a result are left out: what is read is not all that was written."""


def warn_of(path: Path, notes: Iterable[str]) -> None:
    """Warnings, at the caller's caller, of what was found in a store; all but `NO_CHECKSUMS` leave something out."""
    for note in notes:
        kind = DamageWarning if note == NO_CHECKSUMS else LeftOutWarning
        warnings.warn(f"{path}: {note}", kind, stacklevel=3)


def document_digest(document: Record) -> str:
    """Of a JSON document's canonical text without its own `sha256`."""
    return text_digest(ENCODER.encode({key: value for key, value in document.items() if key != KEY}))


def text_digest(text: str) -> str:
    """Of a canonical text."""
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def signed(document: Record) -> Fields:
    """The document with its `sha256` as the last key."""
    rest = {key: value for key, value in document.items() if key != KEY}
    return {**rest, KEY: document_digest(rest)}


def mistake(document: Record) -> str | None:
    """What a note says about a document's checksum; None where it is right."""
    stored = document.get(KEY)
    if stored is None:
        return "has no sha256: written by an earlier contin, or by hand; it cannot be told whether it is as written"
    if stored != document_digest(document):
        return "its sha256 is not that of its content: it was damaged, or changed by hand, after it was written"
    return None


def parts_digest(*parts: str | bytes | int) -> str:
    """Of several texts, bytes and integers, which cannot run into each other, nor one kind be taken for another."""
    digest = hashlib.sha256()
    for part in parts:
        data = part if isinstance(part, bytes) else str(part).encode("utf-8", "surrogatepass")
        digest.update(b"b" if isinstance(part, bytes) else b"t" if isinstance(part, str) else b"i")
        digest.update(len(data).to_bytes(8, "little"))
        digest.update(data)
    return digest.hexdigest()
