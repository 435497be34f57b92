"""Standard output and standard error that never raise: what they cannot take is remembered and named at the end.

Standard output may be closed (`>&-`), full (`> /dev/full`), a pipe whose reader has gone (`| head -1`), a terminal that
was closed, or in an encoding without the characters of a report. None of it may cost a result.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final, TextIO

READER_GONE: Final = "the reader has gone (broken pipe)"
CLOSED: Final = "closed"


class Guarded(io.TextIOBase):
    """A text stream in place of another one. `failure` says why it takes nothing any more; empty while it does."""

    def __init__(self, stream: TextIO | None) -> None:
        super().__init__()
        self._stream = stream
        self.failure = ""

    def write(self, text: str, /) -> int:
        """Write; a character that the encoding does not have goes out as its escape."""
        if self._stream is None:
            self.failure = self.failure or CLOSED
        elif not self.failure:
            try:
                try:
                    self._stream.write(text)
                except UnicodeEncodeError:
                    encoding = self._stream.encoding or "ascii"
                    self._stream.write(text.encode(encoding, "backslashreplace").decode(encoding))
            except (OSError, ValueError) as error:
                self._fail(error)
        return len(text)

    def flush(self) -> None:
        if self._stream is None or self.failure:
            return
        try:
            self._stream.flush()
        except (OSError, ValueError) as error:
            self._fail(error)

    def _fail(self, error: OSError | ValueError) -> None:
        """Remember, and send what is left in the buffer nowhere: Python would complain of it at its end."""
        gone = isinstance(error, OSError) and error.errno == errno.EPIPE
        self.failure = READER_GONE if gone else getattr(error, "strerror", None) or str(error)
        with suppress(OSError, ValueError, AttributeError):
            assert self._stream is not None
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self._stream.fileno())
            os.close(nowhere)

    def isatty(self) -> bool:
        try:
            return self._stream is not None and self._stream.isatty()
        except (OSError, ValueError):
            return False

    def fileno(self) -> int:
        if self._stream is None:
            raise io.UnsupportedOperation("closed")
        return self._stream.fileno()

    def writable(self) -> bool:
        return True

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return getattr(self._stream, "encoding", None) or "utf-8"


@contextmanager
def guarded_streams() -> Iterator[Guarded]:
    """Standard output and error that never raise, until the block ends; gives standard output."""
    _open_what_is_closed()
    before = sys.stdout, sys.stderr
    out, err = Guarded(sys.stdout), Guarded(sys.stderr)
    sys.stdout, sys.stderr = out, err
    try:
        yield out
    finally:
        out.flush()
        err.flush()
        sys.stdout, sys.stderr = before


def _open_what_is_closed() -> None:
    """A standard stream that is closed leaves its number to the next file that is opened, and texts would go there."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            with suppress(OSError):
                os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
