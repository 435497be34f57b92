"""The JSON results of a run that is not finished: after every branch that is, a whole file with all of them so far."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contin.errors import InputError
from contin.records import Fields, Record
from contin.store.digest import ENCODER, KEY, text_digest
from contin.store.json_format import FORMAT_VERSION, branch_document, branch_text, dumps, write_json_text
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
        self.branches: dict[str, tuple[str, str]] = {}  # texts: laid out, and canonical
        self.seconds: dict[str, float] = {}

    def replay(self, key: str, number: int) -> Chunk | None:
        return None

    def record(self, key: str, number: int, chunk: Chunk) -> None:
        return

    def finished(self, branch: Branch) -> None:
        """Write what is finished."""
        if self.trouble:
            return
        document = branch_document(branch)
        self.branches[branch.name] = (branch_text(document), ENCODER.encode(document))
        self.seconds[branch.name] = float(document["seconds"])
        try:
            write_json_text(self._text(), self.place)
        except InputError as error:
            self.trouble = f"{error}; the run went on without keeping its finished branches there"

    def _text(self) -> str:
        """Of the document, signed: each branch is laid out once, not again with every one that follows it."""
        head = {"contin": FORMAT_VERSION, "model": dict(self.model)}
        tail: Fields = {"notes": [NOTE], "timing": {"total": sum(self.seconds.values())}}
        laid, canonical = zip(*self.branches.values(), strict=True)
        whole = f'{{"branches":[{",".join(canonical)}],{ENCODER.encode({**head, **tail})[1:]}'
        opening = dumps(head).removesuffix("\n}\n")
        closing = dumps({**tail, KEY: text_digest(whole)}).removeprefix("{\n")
        return opening + ',\n  "branches": [\n' + ",\n".join(laid) + "\n  ],\n" + closing

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
