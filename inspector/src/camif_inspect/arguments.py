"""What the command line takes: verbs, options, and the bounds of their numbers."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from . import __version__
from .port import DEFAULT_BAUD
from .recording import SUFFIX
from .save import KINDS

_BAUD = "rate of a serial line (%(default)s)"
_URL = "a port, a pty, socket://HOST:PORT or any URL that pyserial takes; or a recording"


def _whole(least: int, most: float = math.inf) -> Callable[[str], int]:
    """Read a whole number within bounds."""

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if not least <= value <= most:
            bounds = f"from {least} on" if most == math.inf else f"from {least} to {most}"
            raise argparse.ArgumentTypeError(f"it takes a whole number {bounds}, not `{text}`")
        return value

    return read


def _amount(zero: bool = False) -> Callable[[str], float]:
    """Read a number above zero, or, where that means something, zero."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if math.isfinite(value) and (value > 0 or (zero and value == 0)):
            return value
        raise argparse.ArgumentTypeError(f"it takes {'zero or ' if zero else ''}a number above zero, not `{text}`")

    return read


class _Parser(argparse.ArgumentParser):
    """One clear line instead of the whole usage."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


def parser() -> argparse.ArgumentParser:
    """Make the parser of the whole command line."""
    whole = _Parser(prog="camif-inspect", description="Receives the frames that a camif device sends, and shows them.")
    whole.add_argument("--version", action="version", version=f"camif-inspect {__version__}")
    verbs = whole.add_subparsers(dest="verb", required=True, metavar="COMMAND")

    def verb(name: str, text: str, url: bool = True) -> argparse.ArgumentParser:
        made = verbs.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
        if url:
            made.add_argument("url", metavar="URL", help=_URL)
            made.add_argument(
                "--baud", type=_whole(1), default=DEFAULT_BAUD, help="rate of a serial line (%(default)s)"
            )
            made.add_argument("--wait", action="store_true", help="wait for a port that is not there yet")
        return made

    view = verbs.add_parser("view", help="show the live picture in the browser")
    view.add_argument("url", metavar="URL", nargs="?", help=_URL)
    view.add_argument("--play", metavar="FILE", type=Path, help="show a recording instead")
    view.add_argument(
        "--speed", type=_amount(zero=True), default=1.0, help="of a recording; 0: no waiting (%(default)s)"
    )
    view.add_argument("--loop", action="store_true", help="play a recording again and again")
    view.add_argument("--baud", type=_whole(1), default=DEFAULT_BAUD, help=_BAUD)
    view.add_argument("--host", default="127.0.0.1", help="address to serve the page at (%(default)s)")
    view.add_argument("--port", type=_whole(0, 65535), default=8137, help="TCP port, 0 for a free one (%(default)s)")
    view.add_argument("--save-to", type=Path, default=Path(), metavar="DIR", help="where the page's Save puts files")
    view.add_argument("--no-browser", action="store_true", help="print the address and open nothing")

    save = verb("save", "save frames as PNG and raw files")
    save.add_argument("-n", "--frames", type=_whole(1), default=1, help="how many (%(default)s)")
    save.add_argument(
        "-o", "--out", type=Path, default=Path(), help="a directory, or for one frame a .png or .raw file"
    )
    save.add_argument("--stream", help="number or name; all, if it is left out")
    save.add_argument("--kind", choices=(*KINDS, "both"), default="both", help="what to write (%(default)s)")
    save.add_argument("--whole", action="store_true", help="pass over frames that have any fault")
    save.add_argument("--no-resend", action="store_true", help="do not ask for missing lines again")
    save.add_argument(
        "--timeout", type=_amount(), default=30.0, help="seconds without a frame to give up after (%(default)s)"
    )
    save.add_argument("--json", action="store_true", help="one JSON object on stdout")

    record = verb("record", "write the bytes of the line to a file, with their times; Ctrl-C ends it")
    record.add_argument("-o", "--out", type=Path, required=True, help=f"the recording, usually *{SUFFIX}")
    record.add_argument("--seconds", type=_amount(), help="end after so long")

    playing = verb("play", "play a recording as if the device were there", url=False)
    playing.add_argument("file", type=Path, help="a recording")
    playing.add_argument("--to", default="tcp:127.0.0.1:0", help="tcp:HOST:PORT or pty (%(default)s)")
    playing.add_argument(
        "--speed", type=_amount(zero=True), default=1.0, help="1 as it was, 0 without waiting (%(default)s)"
    )
    playing.add_argument("--loop", action="store_true", help="again and again")

    stats = verb("stats", "measure what comes over the line; a recording is read whole")
    stats.add_argument("--seconds", type=_amount(), default=5.0, help="how long to listen (%(default)s)")
    stats.add_argument("--json", action="store_true", help="one JSON object on stdout")

    command = verb("command", "ask the device to do something; `help` as the request lists what")
    command.add_argument("request", nargs="+", metavar="REQUEST", help="such as start, snapshot 3, read CR, get")
    command.add_argument(
        "--block", type=_whole(0, 255), default=0, help="of read, write: 0 the interface, 1 the sensor"
    )
    return whole
