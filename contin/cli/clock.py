"""When the command began: imported before anything of ours, so that reports count imports too."""

from __future__ import annotations

import time
from typing import Final

STARTED: Final = time.perf_counter()
