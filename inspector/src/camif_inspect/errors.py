"""What can go wrong outside the program, each as one clear line."""

from __future__ import annotations


class InspectError(Exception):
    """The base of this package's errors. Its text is one line: what, where, and what to do."""


class PortError(InspectError):
    """A port cannot be opened, or vanished."""


class RecordingError(InspectError):
    """A file is no recording, or is one of another version."""


class CommandError(InspectError):
    """The device refused a command, or did not answer."""


class RequestError(CommandError):
    """A request makes no sense, whatever the device is."""


class FormatError(InspectError):
    """A picture is in a format that this version does not know."""
