"""Machine code in files: what it is called, what it needs, and a checksum over all of it.

    8 bytes   contin's mark and the version of this layout
    32 bytes  SHA-256 of what follows
    4 bytes   length of the head
    head      JSON: name, key (a hash of what the code was made from), needs (symbols of others)
    code      an object file

Read data are code that will run, so nothing that fails its checksum is looked at, and nothing is ever unpickled.
"""

from __future__ import annotations

import hashlib
import json
import struct
from dataclasses import dataclass
from typing import Final

MARK: Final = b"contin\x00\x01"
_BEGIN: Final = len(MARK) + 32


@dataclass(frozen=True)
class MachineCode:
    """Machine code of one kernel."""

    name: str
    key: str
    needs: tuple[str, ...]
    code: bytes


def to_bytes(machine_code: MachineCode) -> bytes:
    """The machine code as a file holds it."""
    head = json.dumps({"name": machine_code.name, "key": machine_code.key, "needs": list(machine_code.needs)}).encode()
    body = struct.pack("<I", len(head)) + head + machine_code.code
    return MARK + hashlib.sha256(body).digest() + body


def from_bytes(data: bytes) -> MachineCode | None:
    """The machine code in a file's bytes; None where they are cut, changed or something else."""
    body = data[_BEGIN:]
    if data[: len(MARK)] != MARK or len(body) < 4 or hashlib.sha256(body).digest() != data[len(MARK) : _BEGIN]:
        return None
    (length,) = struct.unpack_from("<I", body)
    head = json.loads(body[4 : 4 + length])
    return MachineCode(head["name"], head["key"], tuple(head["needs"]), body[4 + length :])
