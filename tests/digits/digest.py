"""Prints one hash of the values of all elementary functions: `python tests/digits/digest.py`, on any machine."""

from __future__ import annotations

import hashlib
import struct

from contin.machine import target
from contin.machine.elementary import FUNCTIONS
from tests.machine.elementary.sampled import arguments, compiled


def digest(count: int = 200) -> str:
    """Hash of the bits of every function at random and special arguments."""
    found = hashlib.sha256()
    for name in FUNCTIONS:
        if name != "sincos":
            function = compiled(name)
            for given in arguments(name, count):
                value = function(*given)
                found.update(struct.pack("<d", value) if value == value else b"not a number")
    return found.hexdigest()


if __name__ == "__main__":
    print(target.name(), digest())
