"""`python -m contin.kernels.building FOLDER [TARGET ...]`: archives of machine code, for wheels."""

import sys
from pathlib import Path

from contin.kernels.building.pack import pack
from contin.kernels.building.targets import EVERY, SHIPPED


def main() -> None:
    """Write an archive for every target that is named, or for those that are shipped."""
    folder, *labels = sys.argv[1:]
    for label in labels:
        if label not in EVERY:
            raise SystemExit(f"unknown target {label!r}; known: {', '.join(EVERY)}")
    pack(Path(folder), labels or SHIPPED)


if __name__ == "__main__":
    main()
