"""Failures as exceptions, with the codes of the programs."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Finding:
    """One of the errors of a mechanism: its message, and its place in a data file."""
    message: str
    file: str | None      # None: it is in no file
    line: int | None      # from 1; None for groups that came by add
    column: int | None    # from 1

    def __str__(self) -> str:
        return self.message if self.line is None else f'{self.file}:{self.line}:{self.column}: {self.message}'


class Error(Exception):
    """A failure of the library.

    code: exit code of the programs. message: error, place and remedy. file, line, column: the first place in a data file, or None.
    findings: all errors that were found together. results: what was computed before the failure, or None.
    """

    def __init__(self, message: str, code: int = 1, findings: tuple[Finding, ...] = (), results: Any = None):
        super().__init__(message)
        self.message = message
        self.code = code
        self.findings = findings or (Finding(message, None, None, None),)
        self.results = results

    @property
    def file(self) -> str | None:
        return self.findings[0].file

    @property
    def line(self) -> int | None:
        return self.findings[0].line

    @property
    def column(self) -> int | None:
        return self.findings[0].column

    def __str__(self) -> str:
        return self.message


class UsageError(Error):
    """A call that makes no sense (code 2)."""


class DataError(Error, KeyError):
    """Wrong data, or a name that is not known (code 3). It is a KeyError, too."""


class StructureError(Error):
    """A structure that is no mechanism, or cannot move as is asked (code 4)."""


class AssemblyError(Error):
    """The mechanism cannot be put together (code 5)."""


class SingularError(Error):
    """A singular position, or the branch would change (code 6)."""


class IntegrationError(Error):
    """The integration cannot go on (code 7)."""


class FileError(Error):
    """A file cannot be read or written (code 8)."""


CODES: dict[int, type[Error]] = {2: UsageError, 3: DataError, 4: StructureError, 5: AssemblyError, 6: SingularError, 7: IntegrationError,
                                 8: FileError}
INTERRUPTED = 130
