"""What one page is told, and what it may ask for."""

from __future__ import annotations

import struct
import time
from collections import deque
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from .. import __version__, statistics
from ..ask import ask
from ..commands import Command, read_arguments, read_results, status_text
from ..encodings import NAMES
from ..errors import CommandError, InspectError
from ..frame import Frame
from ..registers import REGISTERS
from ..save import save_frame, sentence, stem
from ..session import Session
from .pictures import Pictures

SAMPLE_SECONDS = 0.5
HISTORY = 240


class History:
    """Rates twice a second, for the plots: the last two minutes."""

    def __init__(self, session: Session) -> None:
        """Begin now."""
        self._session = session
        self.rates: deque[dict[str, Any]] = deque(maxlen=HISTORY)
        self.count = 0
        self._changed: dict[int, tuple[Frame | None, int, float]] = {}
        with session.lock:
            self._last = statistics.sample(session.receiver, time.monotonic())

    def take(self) -> None:
        """Take a sample."""
        with self._session.lock:
            sample = statistics.sample(self._session.receiver, time.monotonic())
        rates = statistics.between(self._last, sample)
        self._last = sample
        self.rates.append(
            {
                "frames": rates.frames,
                "bytes": rates.bytes,
                "lost": rates.lines_lost / rates.seconds if rates.seconds else 0,
                "damaged": rates.damaged / rates.seconds if rates.seconds else 0,
            }
        )
        self.count += 1

    def age(self, number: int, frame: Frame | None, changes: int) -> float:
        """Give the seconds since anything of a stream's picture changed."""
        now = time.monotonic()
        known = self._changed.get(number)
        if known is None or known[0] is not frame or known[1] != changes:
            self._changed[number] = (frame, changes, now)
            return 0.0
        return now - known[2]


def welcome(session: Session) -> dict[str, Any]:
    """Tell a page what it shows, and the register map."""
    return {
        "type": "welcome",
        "version": __version__,
        "source": session.source.name,
        "live": session.source.live,
        "encodings": {str(code): name for code, name in NAMES.items()},
        "sample_seconds": SAMPLE_SECONDS,
        "history": HISTORY,
        "registers": [asdict(register) for register in REGISTERS],
    }


def state(session: Session, history: History) -> dict[str, Any]:
    """Tell how everything is: the port, the streams, the counts, the device."""
    with session.lock:
        receiver = session.receiver
        streams = []
        for number, stream in sorted(receiver.streams.items()):
            newest = stream.open if stream.open is not None and stream.open.reached.any() else None
            newest = newest or (stream.kept[-1] if stream.kept else None)
            info = stream.info
            streams.append(
                {
                    "stream": number,
                    "name": stream.name,
                    "on": info.on if info else None,
                    "encoding": info.encoding if info else None,
                    "pipeline": info.pipeline if info else "",
                    "size": [info.width, info.height] if info else None,
                    "age": history.age(number, newest, newest.changes if newest else 0),
                }
            )
        beat, hello = receiver.heartbeat, receiver.hello
        versions = dict(receiver.versions) if not receiver.counts.received else {}
        counts = asdict(receiver.counts)
    return {
        "type": "state",
        "trouble": session.trouble,
        "ended": session.ended.is_set() and not session.source.live,
        "noisy": session.noisy,
        "noise_hint": session.noise_hint,
        "versions": versions,
        "device": hello.name if hello else None,
        "commands": hello.commands if hello else None,
        "encodings": hello.encodings if hello else None,
        "heartbeat": asdict(beat) | {"state": beat.state_name, "cause": beat.cause_name} if beat else None,
        "counts": counts,
        "streams": streams,
    }


class Desk:
    """Answers what one page asks for."""

    def __init__(self, session: Session, directory: Path) -> None:
        """Serve a page that has seen nothing."""
        self._session = session
        self._directory = directory
        self.pictures = Pictures()
        self.paused = False

    def answer(self, message: dict[str, Any]) -> dict[str, Any]:
        """Do what a page asks for, which may take seconds; gives what to tell it."""
        name = message.get("do")
        handler = _ANSWERS.get(name) if isinstance(name, str) else None
        told: dict[str, Any] = {"type": "answer", "id": message.get("id"), "do": name, "ok": True}
        try:
            if handler is None:
                raise CommandError(f"the page asks for `{name}`, which this program does not know")
            told |= handler(self, message)
        except InspectError as error:
            told |= {"ok": False, "text": str(error)}
        except (KeyError, TypeError, ValueError, OverflowError, struct.error) as error:
            told |= {"ok": False, "text": f"the page asks for `{name}` in a way that makes no sense: {error}"}
        return told

    def _ask(self, message: dict[str, Any]) -> dict[str, Any]:
        request = [str(word) for word in message["request"]]
        if not request:
            raise CommandError("nothing was asked for")
        return {"text": "\n".join(ask(self._session, request, int(message.get("block", 0))))}

    def _pause(self, message: dict[str, Any]) -> dict[str, Any]:
        self.paused = bool(message["paused"])
        return {}

    def _save(self, message: dict[str, Any]) -> dict[str, Any]:
        wanted = message.get("streams")
        frames = [frame for number, frame in sorted(self.pictures.frames.items()) if wanted is None or number in wanted]
        if not frames:
            raise CommandError("there is no picture to save yet")
        files = []
        for frame in frames:
            for kind in ("png", "raw"):
                path = self._directory / f"{stem(frame)}.{kind}"
                with self._session.lock:
                    save_frame(frame, path, kind)
                files.append(str(path))
        self._session.say("information", f"saved {', '.join(sentence(frame) for frame in frames)}")
        return {"files": files, "text": f"saved {len(files)} files: {', '.join(files)}"}

    def _read_registers(self, message: dict[str, Any]) -> dict[str, Any]:
        """Read those that are asked for; one that the device lacks is left out."""
        found, refused = {}, ""
        for offset in message["offsets"]:
            reply = self._session.command(Command.READ, read_arguments(0, int(offset), 1))
            if reply.status == 0 and (words := read_results(reply)):
                found[str(int(offset))] = words[0]
            else:
                refused = status_text(reply)
        if not found:
            raise CommandError(refused or "no register was asked for")
        return {"registers": found}

    def _write_register(self, message: dict[str, Any]) -> dict[str, Any]:
        offset, value = int(message["offset"]), int(message["value"])
        if not 0 <= value <= 0xFFFF_FFFF or not 0 <= offset <= 0xFFFF_FFFF:
            raise CommandError("a register and its offset have 32 bits")
        self._session.write_register(offset, value)
        return {"text": f"wrote {value:#010x} to {offset:#04x}"}

    def _parameters(self, _: dict[str, Any]) -> dict[str, Any]:
        return {"parameters": [asdict(parameter) for parameter in self._session.parameters()]}

    def _set(self, message: dict[str, Any]) -> dict[str, Any]:
        parameter = self._session.set_parameter(int(message["parameter"]), int(message["value"]))
        return {"parameter": asdict(parameter), "text": f"{parameter.name} = {parameter.value}"}

    def _resend(self, message: dict[str, Any]) -> dict[str, Any]:
        frame = self.pictures.frames.get(int(message["stream"]))
        if frame is None:
            raise CommandError("there is no picture yet")
        left = self._session.request_missing(frame)
        return {"text": f"{left} lines are still missing" if left else "every line has come"}


_ANSWERS: dict[str, Callable[[Desk, dict[str, Any]], dict[str, Any]]] = {
    "ask": Desk._ask,
    "pause": Desk._pause,
    "save": Desk._save,
    "read": Desk._read_registers,
    "write": Desk._write_register,
    "parameters": Desk._parameters,
    "set": Desk._set,
    "resend": Desk._resend,
}
