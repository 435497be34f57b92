"""Build hooks: what wheels hold beside the code, and what they need.

- The repository's `models/` goes into wheels as `contin/_models`. An editable install gets no copy: it reads the folder
  in the repository, so an edited model is seen at once.
- `python -m build --wheel` compiles all kernels for the targets that are shipped and puts them into the wheel, which
  then does not depend on numba. `pip install .` does not: to compile what a first run needs takes less time than to
  compile everything. `CONTIN_KERNELS` decides for both: `yes`, `no`, or the targets' names with blanks between them.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

NUMBA = "numba>=0.62"
NEEDED_TO_BUILD = [NUMBA, "llvmlite>=0.45", "numpy>=1.26", "filelock>=3.12"]


def with_kernels() -> bool:
    """Whether this build compiles the kernels; pip marks its own builds in the environment."""
    wanted = os.environ.get("CONTIN_KERNELS", "")
    return wanted != "no" if wanted else "PIP_BUILD_TRACKER" not in os.environ


def targets() -> list[str]:
    """The targets that `CONTIN_KERNELS` names; none: those that are shipped."""
    return [word for word in os.environ.get("CONTIN_KERNELS", "").split() if word != "yes"]


class Dependencies(MetadataHookInterface):
    """numba is needed at run time only where kernels are compiled there."""

    def update(self, metadata: dict[str, Any]) -> None:
        base = list(self.config["base"])
        metadata["dependencies"] = base if with_kernels() else [*base, NUMBA]


class Contents(BuildHookInterface[Any]):
    """Adds models and machine code to a standard wheel and leaves an editable one alone."""

    def dependencies(self) -> list[str]:
        return NEEDED_TO_BUILD if self.target_name == "wheel" and with_kernels() else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if self.target_name != "wheel" or version != "standard":
            return
        build_data["force_include"]["models"] = "contin/_models"
        if with_kernels():
            self.folder = tempfile.TemporaryDirectory()
            code = [sys.executable, "-m", "contin.kernels.building", self.folder.name, *targets()]
            subprocess.run(code, cwd=self.root, env={**os.environ, "PYTHONPATH": self.root}, check=True)
            for path in sorted(Path(self.folder.name).glob("*.zip")):
                build_data["force_include"][str(path)] = f"contin/_kernels/{path.name}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        if hasattr(self, "folder"):
            self.folder.cleanup()
