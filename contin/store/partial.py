"""The JSON results of a run that is not finished: after every branch that is, a whole file with all of them so far."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contin.errors import InputError
from contin.records import Fields, Record
from contin.store.digest import signed
from contin.store.json_format import FORMAT_VERSION, branch_document, dumps, write_json_text
from contin.store.places import beside

if TYPE_CHECKING:
    from contin.continuation.branch import Branch
    from contin.continuation.sample import Chunk

NOTE: Final = "the run was not finished: these are the branches that were"


class PartialJson:
    """A `contin.continuation.journal.Journal` that keeps finished branches in a JSON file, and no chunks.

    The file stands at the place of the result, or beside an earlier result (NAME.json.unfinished), which stays until
    the run has ended. `trouble` says why it stopped keeping, if it did.
    """

    def __init__(self, path: Path, model: Record) -> None:
        self.path, self.trouble, self.model = path, "", model
        self.place = beside(path) if path.exists() and path.stat().st_size else path
        self.branches: dict[str, Fields] = {}

    def replay(self, key: str, number: int) -> Chunk | None:
        return None

    def record(self, key: str, number: int, chunk: Chunk) -> None:
        return

    def finished(self, branch: Branch) -> None:
        """Write what is finished."""
        if self.trouble:
            return
        self.branches[branch.name] = branch_document(branch)
        document = {
            "contin": FORMAT_VERSION,
            "model": dict(self.model),
            "branches": [*self.branches.values()],
            "notes": [NOTE],
            "timing": {"total": float(sum(b["seconds"] for b in self.branches.values()))},
        }
        try:
            write_json_text(dumps(signed(document)), self.place)
        except InputError as error:
            self.trouble = f"{error}; the run went on without keeping its finished branches there"

    def give_up(self) -> None:
        """The user wants no result: the unfinished file is removed."""
        with suppress(OSError):
            self.place.unlink(missing_ok=True)

    def rest(self) -> None:
        """There is nothing to fold: every file that was written is whole."""

    def close(self, saved: bool = False) -> None:
        """What was kept beside is removed once the finished result is `saved` at its place."""
        if saved and self.place != self.path:
            with suppress(OSError):
                self.place.unlink(missing_ok=True)
