"""Errors that a user of contin can do something about: one base, one subclass per kind of remedy.

Numerical trouble on a branch is never one of these: it is a status in the branch's `ends`.
"""


class ContinError(Exception):
    """Base of every error that contin raises on purpose; its text says where, what, and what to write instead."""


class InputError(ContinError, ValueError):
    """A model, run file, command line or call that cannot be carried out as written (exit code 2)."""


class ExpressionError(InputError):
    """A formula that does not follow the grammar; `position` is the 0-based offset in the text."""

    def __init__(self, message: str, position: int = 0) -> None:
        super().__init__(message)
        self.position = position


class UserFunctionError(InputError):
    """A user's Python function raised an error, or returned something of the wrong shape or type."""


class ModelNotFoundError(InputError):
    """No bundled, plugin or file model has this name."""


class NotFiniteError(ContinError, ArithmeticError):
    """The equations give NaN or infinity at a point where a value is needed; the text names the equation."""


class NoSolutionError(ContinError, ArithmeticError):
    """No solution was found from the given start; the text has the residual history and the nearest one found."""


class AtRestError(NoSolutionError):
    """There is no periodic orbit because the trajectory comes to rest, at `state`."""

    def __init__(self, message: str, state: object = None) -> None:
        super().__init__(message)
        self.state = state


class FormatVersionError(InputError):
    """A file was written for a newer format than this version of contin reads."""


class InputWarning(UserWarning):
    """Something in a file or a call that can be carried out, but is hardly what was meant."""
