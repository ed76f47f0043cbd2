"""Exceptions of Flexmorph, with the location in the case file."""

import re

from . import _core

_LOCATED = re.compile(r"(?P<file>[^:\n]+):(?P<line>\d+):(?:(?P<column>\d+):)? ?(?P<rest>.*)", re.S)
_OPTION = re.compile(r"--set (?P<key>[^=\s]+)=(?P<rest>.*)", re.S)
_KEY = re.compile(r"(?P<key>[A-Za-z_][\w.\"-]*)(?: = |: )")


class Error(Exception):
    """An error that Flexmorph reports to the user.

    Attributes
    ----------
    file : str or None
        Case file of the error; None if the message names none.
    line, column : int or None
        Location in the file, from 1.
    key : str or None
        Dotted path of the key in the case, such as ``"body.thickness"``.
    """

    def __init__(self, message=""):
        super().__init__(message)
        self.file = self.line = self.column = self.key = None
        first = str(message).split("\n", 1)[0]
        option, located = _OPTION.match(first), _LOCATED.match(first)
        if option:
            self.key = option["key"]
        elif located:
            self.file, self.line = located["file"], int(located["line"])
            self.column = int(located["column"]) if located["column"] else None
            key = _KEY.match(located["rest"])
            self.key = key["key"] if key else None


class InputError(Error, ValueError):
    """The input cannot be used: a case, an argument, or a file (exit code 2 of the program)."""


class NumericalError(Error, ArithmeticError):
    """A computation failed (exit code 3 of the program)."""


_core.InputError = InputError
_core.NumericalError = NumericalError
