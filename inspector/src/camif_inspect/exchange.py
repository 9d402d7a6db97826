"""Commands and their replies: one command at a time, sent again until its reply comes."""

from __future__ import annotations

import queue
import random
import threading
import time
from collections.abc import Callable

from .commands import Command
from .errors import CommandError
from .packet import DELIMITER, Reply, command_wire

REPLY_SECONDS = 1.0
_ATTEMPTS = 4
# How long replies may come late in all because this end lags behind: they come behind frames that wait to be read.
_LAG_SECONDS = 15.0
# A greeting that stays without an answer must not hold up the commands of a person for long.
_GREETINGS = 2
_LOOK_SECONDS = 0.1


class Exchange:
    """Sends commands, and finds the reply of each among those that come.

    Attributes:
        replies: what the listening thread hands over.
        caught_up: when a read last began with nothing waiting to be read, by the monotonic clock.
    """

    def __init__(self, name: str, send: Callable[[bytes], None], check: Callable[[], None]) -> None:
        """Take a note of the port's name, what sends bytes to it, and what raises `PortError` if it is gone."""
        self.replies: queue.Queue[Reply] = queue.Queue()
        self.caught_up = time.monotonic()
        self._name = name
        self._send = send
        self._check = check
        self._lock = threading.Lock()
        self._request = random.randrange(1 << 16)

    def ask(self, command: Command | int, arguments: bytes, timeout: float) -> Reply:
        """Send a command and give its reply; raises `CommandError` if none comes, though it was sent four times."""
        return self._exchange(int(command), arguments, timeout, _ATTEMPTS, _LAG_SECONDS)

    def greet(self) -> None:
        """Ask who is there, less patiently."""
        self._exchange(Command.HELLO, b"", REPLY_SECONDS, _GREETINGS, 0)

    def _exchange(self, command: int, arguments: bytes, timeout: float, attempts: int, lag: float) -> Reply:
        with self._lock:
            self._request = (self._request + 1) % (1 << 16)
            wire = DELIMITER + command_wire(self._request, command, arguments)
            while not self.replies.empty():
                self.replies.get_nowait()
            latest = time.monotonic() + attempts * timeout + lag
            for _ in range(attempts):
                self._send(wire)
                reply = self._reply(command, time.monotonic() + timeout, latest)
                if reply is not None:
                    return reply
        name = Command(command).name if command in Command._value2member_map_ else str(command)
        raise CommandError(f"no reply to {name} from {self._name}, asked {attempts} times")

    def _reply(self, command: int, deadline: float, latest: float) -> Reply | None:
        """Wait for the reply to the last request; None if it has not come in time.

        Time is up when all that had come by the deadline has been read. A reply comes behind whatever the device sent
        before it: over a fast line that is megabytes, and seconds for a busy machine.
        """
        while True:
            now = time.monotonic()
            over = now >= deadline and (self.caught_up >= deadline or now >= latest)
            wait = 0.0 if over else min(max(deadline - now, 0.02), _LOOK_SECONDS)
            try:
                reply = self.replies.get(timeout=wait)
            except queue.Empty:
                self._check()
                if over:
                    return None
                continue
            if (reply.request, reply.command) == (self._request, command):
                return reply
