"""The exceptions. Every message names the place, the cause and the remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._mesh import Remeshed


class SpectralRemeshError(Exception):
    """Base class of all errors of this package."""


class ArgumentError(SpectralRemeshError, ValueError):
    """An argument is invalid: a wrong shape, NaN, an index without a vertex, a number out of range.

    Attributes:
        argument: The name of the argument.
        cause: What is wrong, and how to correct it.
    """

    def __init__(self, argument: str, cause: str) -> None:
        super().__init__(argument, cause)
        self.argument = argument
        self.cause = cause

    def __str__(self) -> str:
        return f"{self.argument}: {self.cause}"


class FileError(SpectralRemeshError, OSError):
    """A file cannot be opened, read, created, written or renamed, or its format cannot be determined."""


class FormatError(SpectralRemeshError):
    """The content of a file does not conform to its format."""


class MeshError(SpectralRemeshError):
    """A mesh or a cloud cannot be used: for instance, it has no area, or no surface passes through its points."""


class NotVerifiedError(SpectralRemeshError):
    """With ``strict=True``: the result fails a check, such as that of its topology.

    Attributes:
        remeshed: The result that failed.
    """

    def __init__(self, remeshed: Remeshed) -> None:
        super().__init__(remeshed)
        self.remeshed = remeshed

    def __str__(self) -> str:
        why = ", ".join(self.remeshed.shortcomings)
        return f"the result is not verified: {why}; try another seed or more points"
