"""The targets that kernels can be built for, on any machine: a processor level on a kind of system."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any, Final

from contin.machine import target

SYSTEMS: Final = ("linux", "darwin", "win32")


@dataclass(frozen=True)
class BuildTarget:
    """`x86-64-v3-linux`, say. Object files of one level differ between systems: in format, and in how they call."""

    level: str
    system: str
    triple: str
    processor: str

    @property
    def name(self) -> str:
        return f"{self.level}-{self.system}"

    def machine(self) -> Any:
        """LLVM's target machine, for object files that are loaded anywhere in memory."""
        return target.object_machine(self.triple, self.processor)


def _x86(level: str, system: str) -> BuildTarget:
    ends = {"linux": "unknown-linux-gnu", "darwin": "apple-macosx11.0", "win32": "pc-windows-msvc-elf"}
    return BuildTarget(level, system, f"x86_64-{ends[system]}", level)


EVERY: Final = {
    t.name: t
    for t in (
        *(_x86(level, system) for level in target.LEVELS for system in SYSTEMS),
        BuildTarget("aarch64", "linux", "aarch64-unknown-linux-gnu", "generic"),
        BuildTarget("aarch64", "darwin", "arm64-apple-macosx11.0", "apple-m1"),
    )
}
SHIPPED: Final = ("x86-64-v3-linux", "x86-64-v2-linux", "aarch64-linux", "aarch64-darwin", "x86-64-v3-win32")
"""What wheels hold. The last two are made here and have never been executed here."""


def host_name() -> str:
    """The target of this process."""
    system = sys.platform if sys.platform in SYSTEMS else "linux"
    return f"{target.name()}-{system}"
