"""`python -m runs NAME..`: as `contin run metronomes/NAME` of each, in one process that imports everything once."""

import sys

from contin.cli.main import main

for name in sys.argv[1:]:
    try:
        main(["run", f"metronomes/{name}", "--quiet"])
    except SystemExit as end:
        if end.code not in (0, 1):  # 1: something has a note; pages check what they take from the results
            raise
