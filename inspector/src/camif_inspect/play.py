"""A recording played on a TCP port or a pseudo-terminal, as if the device were there."""

from __future__ import annotations

import os
import select
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress

from .errors import InspectError
from .port import EndOfSource, RecordedSource

Send = Callable[[bytes], None]
Channel = AbstractContextManager[Send]
# How long a listener may take for what is left at the end.
_DRAIN_SECONDS = 10.0
_QUIET_SECONDS = 0.3


def _overhear(channel: int | socket.socket, read: Callable[[int], bytes]) -> None:
    """Take commands off the channel, so that they do not fill it: a recording has no answer to them."""
    while select.select([channel], [], [], 0)[0] and read(1 << 12):
        pass


@contextmanager
def _tcp(place: str, announce: Callable[[str], None]) -> Iterator[Send]:
    host, _, port = place.rpartition(":")
    host = host.strip("[]") or "127.0.0.1"
    if not port.isdigit():
        raise InspectError(f"`tcp:{place}` is no address; write tcp:HOST:PORT, with port 0 for a free one")
    try:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        listener = socket.create_server((host, int(port)), family=family)
    except (OSError, OverflowError) as error:
        raise InspectError(f"cannot listen on {host} port {port}: {error}") from error
    with listener:
        announce(f"socket://{host}:{listener.getsockname()[1]}")
        connection, _ = listener.accept()
        with connection:

            def send(data: bytes) -> None:
                _overhear(connection, connection.recv)
                connection.sendall(data)

            yield send
            # A socket closed over commands that nobody read is reset, and what is on its way is lost.
            deadline = time.monotonic() + _DRAIN_SECONDS
            connection.shutdown(socket.SHUT_WR)
            connection.settimeout(0.1)
            while time.monotonic() < deadline:
                with suppress(TimeoutError):
                    if not connection.recv(1 << 12):
                        break


@contextmanager
def _pty(announce: Callable[[str], None]) -> Iterator[Send]:
    try:
        import pty
        import tty
    except ImportError:
        raise InspectError("this system has no pseudo-terminals; use --to tcp:HOST:PORT") from None
    controller, terminal = pty.openpty()
    try:
        tty.setraw(terminal)
        announce(os.ttyname(terminal))

        def send(data: bytes) -> None:
            _overhear(controller, lambda most: os.read(controller, most))
            while data:
                data = data[os.write(controller, data) :]

        yield send
        # What the listener has not taken yet would be lost with the terminal; one that is gone takes no more.
        # The kernel moves bytes along in its own time: empty for one look does not mean empty.
        deadline = time.monotonic() + _DRAIN_SECONDS
        empty_since = time.monotonic()
        while time.monotonic() < min(deadline, empty_since + _QUIET_SECONDS):
            if select.select([terminal], [], [], 0)[0]:
                empty_since = time.monotonic()
            time.sleep(0.01)
    finally:
        os.close(terminal)
        os.close(controller)


def channel_at(place: str, announce: Callable[[str], None]) -> Channel:
    """Give the channel at `tcp:HOST:PORT` or `pty`; once entered, `announce` is told the URL to open."""
    if place == "pty":
        return _pty(announce)
    if place.startswith("tcp:"):
        return _tcp(place.removeprefix("tcp:"), announce)
    raise InspectError(f"`{place}` is neither tcp:HOST:PORT nor pty")


def play(source: RecordedSource, channel: Channel, progress: Callable[[int], None]) -> int:
    """Play a recording, once somebody is there to hear it; gives the bytes played.

    `progress` is told how far in the file it is, in bytes. Ends when the recording does, or when the listener leaves.
    """
    played = 0
    with channel as send, suppress(EndOfSource, BrokenPipeError, ConnectionResetError):
        source.open()
        while True:
            data = source.read().data
            if data:
                send(data)
                played += len(data)
                progress(source.reader.position)
    return played
