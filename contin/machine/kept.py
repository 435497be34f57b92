"""Machine code by name: from the wheel, else from the user's folder; kept there when it had to be made."""

from __future__ import annotations

from contin.machine import objects, packed, progress
from contin.machine.folder import folder
from contin.machine.objects import MachineCode


def find(name: str, key: str, file: str) -> MachineCode | None:
    """The machine code made from a text with this key; `file` is its name in the folder, versions and target included.

    A file that is not what it should be is removed, with a note.
    """
    shipped = packed.find(name, key)
    if shipped is not None:
        return shipped
    place = folder()
    data = place.read(file) if place else None
    if place is None or data is None:
        return None
    machine_code = objects.from_bytes(data)
    if machine_code is None or (machine_code.name, machine_code.key) != (name, key):
        progress.note(f"{place.path / file} was damaged: it is made anew")
        place.remove(file)
        return None
    return machine_code


def keep(machine_code: MachineCode, file: str) -> None:
    """Put machine code into the folder, if there is one and it takes it."""
    place = folder()
    if place is not None:
        place.write(file, objects.to_bytes(machine_code))
