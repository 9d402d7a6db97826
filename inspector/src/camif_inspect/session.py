"""A session with a device: a thread that listens, commands and their replies, and waiting for a port that vanished."""

from __future__ import annotations

import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import TracebackType

import numpy as np

from . import commands
from .commands import Command, Parameter
from .errors import CommandError, InspectError, PortError, RequestError
from .exchange import REPLY_SECONDS, Exchange
from .frame import Frame
from .packet import COMMAND_HEAD, LARGEST_COMMAND, VERSION, Hello, Log, OtherVersion, Reply
from .port import EndOfSource, Source
from .receiver import Event, Receiver
from .recording import FROM_DEVICE, TO_DEVICE, RecordingWriter

_RETRY_SECONDS = 0.25
# Bytes without a single packet after which a person is told that this is no device, or another rate.
_NOISE_BYTES = 16_384
_QUEUED_FRAMES = 64

Listener = Callable[[Event], None]


class Session:
    """Listens to one source until it is closed, or a recording ends.

    Attributes:
        source: where the bytes come from.
        receiver: what they mean; hold `lock` while looking at it.
        lock: guards the receiver.
        log: the device's latest log lines, and what this end has to say, as (seconds, level, text).
        trouble: what is wrong with the port now; None when it is open.
    """

    def __init__(self, source: Source, wait: bool = False, recorder: RecordingWriter | None = None) -> None:
        """Open the source and, if it is a port, begin to listen; `recorder` has all bytes, from the first one on.

        A port that cannot be opened raises `PortError`, unless `wait` says to wait for it. One that vanishes later is
        always waited for.
        """
        self.source = source
        self.receiver = Receiver(joins_midway=source.live)
        self.lock = threading.Lock()
        self.log: deque[tuple[float, str, str]] = deque(maxlen=1000)
        self.log_count = 0
        self._log_lock = threading.Lock()
        self.trouble: str | None = None
        self.ended = threading.Event()
        self.last_data: float | None = None
        self.reconnects = 0
        self._listeners: list[Listener] = []
        self._write_lock = threading.Lock()
        self._recorder: tuple[RecordingWriter, float] | None = None
        self.record(recorder)
        self._exchange = Exchange(source.name, self._send, self._check_port)
        self._stop = threading.Event()
        self._failure: BaseException | None = None
        self._since_packet = 0
        self._greeted: tuple[int, str] | None = None
        try:
            source.open()
        except PortError as error:
            if not wait:
                raise
            self._lost(error)
        self._thread = threading.Thread(target=self._listen, name="camif-inspect listener", daemon=True)
        self._started = False
        if source.live:
            self.start()
            if not self.trouble:
                self._greet()

    def start(self) -> None:
        """Begin to listen. A port is listened to from the start; a recording waits for this, or for `frames`."""
        if not self._started:
            self._started = True
            self._thread.start()

    def __enter__(self) -> Session:
        """Give the session."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Stop listening and close the source."""
        self._stop.set()
        if self._started and self._thread is not threading.current_thread():
            self._thread.join(timeout=3)
        self.source.close()
        self.ended.set()

    # Listening.

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Call `listener` with every event, in the listening thread; gives what ends that."""
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener) if listener in self._listeners else None

    def say(self, level: str, text: str) -> None:
        """Add a line to the log as this end's own."""
        with self._log_lock:
            self.log.append((self.source.now(), level, text))
            self.log_count += 1

    def said_since(self, count: int) -> tuple[list[tuple[float, str, str]], int]:
        """Give the log's lines after the first `count` ones, as far as they are kept, and how many there are now."""
        with self._log_lock:
            new = self.log_count - count
            return list(self.log)[-new:] if new else [], self.log_count

    def record(self, writer: RecordingWriter | None) -> None:
        """Write all bytes, both ways, to a recording from now on; None ends it."""
        with self._write_lock:
            self._recorder = (writer, self.source.now()) if writer else None

    def _record(self, at: float, data: bytes, direction: int) -> None:
        with self._write_lock:
            if self._recorder is not None:
                writer, started = self._recorder
                writer.write(max(0.0, at - started), data, direction)

    def _lost(self, error: PortError) -> None:
        if self.trouble is None:
            self.say("warning", f"{error}; waiting for it")
        self.trouble = str(error)

    def _listen(self) -> None:
        try:
            while not self._stop.is_set():
                if self.trouble is not None and not self._reopen():
                    continue
                begun = time.monotonic()
                try:
                    chunk = self.source.read()
                except PortError as error:
                    self._lost(error)
                    continue
                if chunk.caught_up:
                    self._exchange.caught_up = begun
                if chunk.data:
                    self._take(chunk.time, chunk.data)
        except EndOfSource as end:
            if end.cut_short:
                self.say("warning", str(end))
            self.trouble = "the recording is at its end"
        except BaseException as error:  # handed to whoever asks next
            self._failure = error
        finally:
            self.ended.set()

    def _reopen(self) -> bool:
        self._stop.wait(_RETRY_SECONDS)
        if self._stop.is_set():
            return False
        try:
            self.source.open()
        except PortError as error:
            self._lost(error)
            return False
        self.trouble = None
        self.reconnects += 1
        self.say("information", f"{self.source.name} is open")
        with self.lock:
            self.receiver.rejoin()
        self._greet()
        return True

    def _greet(self) -> None:
        """Ask who is there: a device says it when it starts, and that may have been long ago.

        A device that cannot hear us, or has no answer, is listened to all the same.
        """

        def ask() -> None:
            with suppress(InspectError):
                self._exchange.greet()

        threading.Thread(target=ask, name="camif-inspect greeting", daemon=True).start()

    def _take(self, at: float, data: bytes) -> None:
        self._record(at, data, FROM_DEVICE)
        self.last_data = at
        with self.lock:
            counts = self.receiver.counts
            before = counts.received + counts.other_version
            events = self.receiver.feed(data)
            understood = counts.received + counts.other_version > before
        self._watch_for_noise(len(data), understood)
        for event in events:
            if isinstance(event, Reply):
                self._exchange.replies.put(event)
            elif isinstance(event, Log):
                if event.lost:
                    self.say("warning", f"{event.lost} lines of the device's log were lost")
                self.say(event.level_name, event.text + (" …" if event.cut else ""))
            elif isinstance(event, OtherVersion):
                self._other_version(event)
            elif isinstance(event, Hello) and self._greeted != (event.session, event.name):
                self._greeted = (event.session, event.name)
                self.say("information", f"{event.name or 'a device'}, protocol version {VERSION}")
            for listener in list(self._listeners):
                listener(event)

    def _watch_for_noise(self, length: int, understood: bool) -> None:
        if understood:
            self._since_packet = 0
            return
        before = self._since_packet
        self._since_packet += length
        if before < _NOISE_BYTES <= self._since_packet:
            self.say("warning", f"{self._since_packet} bytes without a packet: {self.noise_hint}")

    @property
    def noisy(self) -> bool:
        """Whether bytes come, and no packets."""
        return self._since_packet >= _NOISE_BYTES

    @property
    def noise_hint(self) -> str:
        """What to do when bytes come, and no packets."""
        baud = getattr(self.source, "baud", None)
        rate = f"another baud rate than {baud:,}, or " if baud and "://" not in self.source.name else ""
        return f"{rate}no camif device"

    def _other_version(self, event: OtherVersion) -> None:
        if self.receiver.versions[event.version] == 1:
            self.say("error", self.version_text(event))

    @staticmethod
    def version_text(event: OtherVersion) -> str:
        """Say what a device speaks that this program does not."""
        spoken = str(event.version)
        if event.oldest_version is not None and event.oldest_version != event.newest_version:
            spoken = f"{event.oldest_version} to {event.newest_version}"
        older = "update this program" if event.version > VERSION else "update the device's firmware"
        return f"the device speaks version {spoken} of the protocol, this program version {VERSION}: {older}"

    # Frames.

    def frames(
        self,
        stream: int | str | None = None,
        timeout: float | None = None,
        idle: Callable[[], None] | None = None,
    ) -> Iterator[Frame]:
        """Give frames as they end: of one stream, by number or name, or of all.

        Ends with a recording. With a `timeout`, in seconds, a longer silence raises `InspectError`. Frames that nobody
        takes are dropped, the oldest first, once 64 wait; of a recording every one is given. `idle` is called now and
        then while none has come.
        """
        waiting: queue.Queue[Frame] = queue.Queue(0 if self.source.live else _QUEUED_FRAMES)

        def arrived(event: Event) -> None:
            if not isinstance(event, Frame) or stream not in (None, event.stream, event.name):
                return
            if self.source.live:
                while waiting.qsize() >= _QUEUED_FRAMES:
                    waiting.get_nowait()
                waiting.put(event)
                return
            while not self._stop.is_set() and not stopped.is_set():
                try:
                    waiting.put(event, timeout=0.1)
                    return
                except queue.Full:
                    continue

        stopped = threading.Event()
        stop = self.listen(arrived)
        self.start()
        silent_since = time.monotonic()
        try:
            while True:
                over = self.ended.is_set()
                try:
                    frame = waiting.get(timeout=0.05)
                except queue.Empty:
                    self.check()
                    if idle is not None:
                        idle()
                    if over:
                        return
                    if timeout is not None and time.monotonic() - silent_since > timeout:
                        raise InspectError(self.silence(timeout, stream)) from None
                    continue
                yield frame
                silent_since = time.monotonic()
        finally:
            stopped.set()
            stop()

    def introduced(self, seconds: float = 1.0) -> bool:
        """Wait until the device has said who it is and what its streams are; False if it does not in that time."""
        until = time.monotonic() + seconds
        while True:
            with self.lock:
                hello, streams = self.receiver.hello, self.receiver.streams
                if hello is not None and all(
                    number in streams and streams[number].info is not None for number in range(hello.streams)
                ):
                    return True
            if time.monotonic() >= until or self.ended.is_set():
                return False
            time.sleep(0.01)

    def check(self) -> None:
        """Raise what went wrong in the listening thread, if anything did."""
        if self._failure is not None:
            failure, self._failure = self._failure, None
            raise failure

    def silence(self, seconds: float, stream: int | str | None = None) -> str:
        """Say why no frame, of a stream or of any, may have come for so long."""
        said = f"no frame{'' if stream is None else f' of stream {stream}'} for {seconds:g} s"
        reason = self.trouble or self._no_packet()
        if reason is not None:
            return f"{said}: {reason}"
        with self.lock:
            known = [known for _, known in sorted(self.receiver.streams.items())]
            beat = self.receiver.heartbeat
        wanted = [one for one in known if stream in (one.number, one.name)]
        if stream is not None and not wanted:
            return f"{said}: the device has {', '.join(f'{one.number} ({one.name})' for one in known) or 'no streams'}"
        if beat is not None and beat.state == 0:
            return f"{said}: the device is stopped; start it with `camif-inspect command URL start`"
        if any(one.info is not None and not one.info.on for one in wanted):
            return f"{said}: it is off; turn it on with `camif-inspect command URL streams all`"
        return said

    def _no_packet(self) -> str | None:
        """Say why not a packet has come; None if one has."""
        counts = self.receiver.counts
        if counts.received:
            return None
        if self.receiver.versions:
            return self.version_text(OtherVersion(next(iter(self.receiver.versions))))
        if counts.bytes == 0:
            return f"{self.source.name} is open, but not a byte has come"
        return f"{counts.bytes:,} bytes came and no packet: {self.noise_hint}"

    # Commands.

    def command(self, command: Command | int, arguments: bytes = b"", timeout: float = REPLY_SECONDS) -> Reply:
        """Send a command and give the reply, whatever its status.

        A command without a reply within `timeout` seconds is sent again, four times in all: the device carries it out
        once. Raises `CommandError` when no reply comes, `PortError` when the port is gone.
        """
        if threading.current_thread() is self._thread:
            raise RuntimeError("a listener cannot wait for a reply: it is what receives it")
        hello = self.receiver.hello
        most = (hello.largest_received if hello else LARGEST_COMMAND) - COMMAND_HEAD
        if len(arguments) > most:
            raise RequestError(f"a command of {len(arguments)} bytes is too long: the device takes {most}")
        try:
            return self._exchange.ask(command, arguments, timeout)
        except CommandError as error:
            reason = self._no_packet()
            raise CommandError(f"{error}: {reason}" if reason else str(error)) from None

    def _send(self, wire: bytes) -> None:
        self._record(self.source.now(), wire, TO_DEVICE)
        self.source.write(wire)

    def _check_port(self) -> None:
        if self.trouble or self._stop.is_set():
            raise PortError(self.trouble or f"{self.source.name} was closed")

    def demand(self, command: Command | int, arguments: bytes = b"") -> Reply:
        """Send a command; raises `CommandError` with the device's words if it is refused."""
        reply = self.command(command, arguments)
        if reply.status != 0:
            raise CommandError(commands.status_text(reply))
        return reply

    def read_registers(self, offset: int, count: int = 1, block: int = 0) -> list[int]:
        """Read registers of a block: 0 is the camera interface, 1 the sensor."""
        return commands.read_results(self.demand(Command.READ, commands.read_arguments(block, offset, count)))

    def write_register(self, offset: int, value: int, block: int = 0) -> None:
        """Write a register of a block."""
        self.demand(Command.WRITE, commands.write_arguments(block, offset, value))

    def parameters(self) -> list[Parameter]:
        """Ask for all parameters of the device."""
        found: list[Parameter] = []
        while True:
            reply = self.command(Command.GET, len(found).to_bytes(2, "little"))
            if reply.status != 0:
                return found
            found.append(commands.parameter_of(reply))

    def set_parameter(self, parameter: int, value: int) -> Parameter:
        """Set a parameter; gives what it is now."""
        return commands.parameter_of(self.demand(Command.SET, commands.set_arguments(parameter, value)))

    def request_missing(self, frame: Frame, timeout: float = 5.0) -> int:
        """Ask for the missing lines of a frame again and wait for them; gives how many are still missing.

        The lines go to their places in the frame itself. Raises `CommandError` if the device no longer holds it.
        """
        deadline = time.monotonic() + timeout
        missing = frame.missing
        edges = np.flatnonzero(np.diff(np.concatenate(([0], missing.view(np.int8), [0]))))
        for first, after in edges.reshape(-1, 2):
            self.demand(
                Command.RESEND,
                commands.resend_arguments(frame.stream, int(first), frame.sequence, int(after - first)),
            )
        while frame.missing.any() and time.monotonic() < deadline and not self.ended.is_set():
            time.sleep(0.01)
        return int(np.count_nonzero(frame.missing))
