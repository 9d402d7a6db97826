"""Requests as people write them, to a device and back."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from . import commands
from .commands import Command, number
from .errors import CommandError, RequestError
from .packet import Hello
from .registers import BY_NAME, BY_OFFSET
from .session import Session


def ask(session: Session, request: Sequence[str], block: int = 0) -> Iterator[str]:
    """Ask the device to do something, and give the lines of its answer.

    ping                        is it there, and how long does an answer take
    hello                       who it is and what it can do
    start | stop                capture
    snapshot [N]                capture N frames (1), then stop
    streams all | none | N,…    which streams are on
    encoding STREAM|all NAME    raw, run-length, qoi, bits, bits-run-length, or auto
    stages STREAM [PIPELINE]    such as 'gray|canny:low=50,high=150'; none, if it is left out
    get [PARAMETER]             all parameters, or one by name or number
    set PARAMETER VALUE
    read REGISTER [COUNT]       by name, such as CR, or by offset, such as 0x0C; all that can be read: read all
    write REGISTER VALUE
    heartbeat                   its statistics
    """
    word, *rest = request
    handler, least, most = _REQUESTS.get(word, (None, 0, 0))
    if handler is None:
        raise RequestError(f"`{word}` is no request; there are {', '.join(_REQUESTS)}")
    if not least <= len(rest) <= most:
        raise RequestError(
            f"{word} takes {least if least == most else f'{least} to {most}'} arguments, not {len(rest)}"
        )
    if not 0 <= block <= 255:
        raise RequestError(f"a block is 0 to 255, not {block}")
    return handler(session, rest, block)


def _ping(session: Session, _: list[str], __: int) -> Iterator[str]:
    begin = session.source.now()
    data = b"camif-inspect"
    if session.demand(Command.PING, data).rest != data:
        raise CommandError("the device answers, but with other bytes than it was sent")
    yield f"answered in {1000 * (session.source.now() - begin):.1f} ms"


def _hello(session: Session, _: list[str], __: int) -> Iterator[str]:
    found: list[Hello] = []
    stop = session.listen(lambda event: found.append(event) if isinstance(event, Hello) else None)
    try:
        session.demand(Command.HELLO)
        _wait(session, lambda: bool(found))
    finally:
        stop()
    if not found:
        raise CommandError("the device answered, but its HELLO did not come")
    hello = found[-1]
    yield f"{hello.name}, protocol version {hello.oldest_version} to {hello.newest_version}"
    known = [command.name.lower() for command in Command if hello.commands >> command & 1]
    yield f"commands: {', '.join(known)}"
    with session.lock:
        streams = [session.receiver.streams[key] for key in sorted(session.receiver.streams)]
    for stream in streams:
        if stream.info:
            info = stream.info
            made = f", made by {info.pipeline}" if info.pipeline else ""
            yield f"stream {info.stream} {info.name}: {info.width} × {info.height}, {'on' if info.on else 'off'}{made}"


def _simple(command: Command, answer: str) -> Callable[[Session, list[str], int], Iterator[str]]:
    def handler(session: Session, _: list[str], __: int) -> Iterator[str]:
        session.demand(command)
        yield answer

    return handler


def _snapshot(session: Session, rest: list[str], _: int) -> Iterator[str]:
    count = number(rest[0], "the number of frames", 1, 65_535) if rest else 1
    session.demand(Command.SNAPSHOT, count.to_bytes(2, "little"))
    yield f"captures {count} frame{'s' if count > 1 else ''}"


def _streams(session: Session, rest: list[str], _: int) -> Iterator[str]:
    if rest[0] in ("all", "none"):
        hello = session.receiver.hello
        mask = 0 if rest[0] == "none" else (1 << hello.streams) - 1 if hello else 0xFFFF_FFFF
    else:
        mask = sum(1 << number(part, "a stream", 0, 31) for part in set(rest[0].split(",")))
    reply = session.demand(Command.STREAMS, mask.to_bytes(4, "little"))
    on = int.from_bytes(reply.rest[:4], "little")
    yield "on: " + (", ".join(str(place) for place in range(32) if on >> place & 1) or "none")


def _encoding(session: Session, rest: list[str], _: int) -> Iterator[str]:
    stream = 255 if rest[0] == "all" else number(rest[0], "a stream", 0, 31)
    session.demand(Command.ENCODING, bytes((stream, commands.encoding_code(rest[1]))))
    yield f"stream {rest[0]}: {rest[1]}"


def _stages(session: Session, rest: list[str], _: int) -> Iterator[str]:
    stream = number(rest[0], "a stream", 0, 31)
    pipeline = rest[1] if len(rest) > 1 else ""
    reply = session.demand(Command.STAGES, commands.stages_arguments(stream, pipeline))
    yield f"stream {stream}: {reply.rest[4:].decode(errors='replace') or 'as captured'}"


def _parameter(session: Session, text: str) -> commands.Parameter:
    found = session.parameters()
    for parameter in found:
        # A name may end with its unit: `exposure, lines`.
        if text == str(parameter.number) or text.lower() == parameter.name.split(",")[0].split(" (")[0].lower():
            return parameter
    names = ", ".join(parameter.name for parameter in found) or "none"
    raise CommandError(f"the device has no parameter `{text}`; it has {names}")


def _described(parameter: commands.Parameter) -> str:
    return f"{parameter.name} = {parameter.value} ({parameter.least} to {parameter.greatest})"


def _get(session: Session, rest: list[str], _: int) -> Iterator[str]:
    wanted = [_parameter(session, rest[0])] if rest else session.parameters()
    yield from map(_described, wanted)
    if not wanted:
        yield "no parameters"


def _set(session: Session, rest: list[str], _: int) -> Iterator[str]:
    parameter = _parameter(session, rest[0])
    value = number(rest[1], parameter.name, -(1 << 31), (1 << 31) - 1)
    yield _described(session.set_parameter(parameter.number, value))


def _offset(text: str, block: int) -> int:
    if block == 0 and text.upper() in BY_NAME:
        return BY_NAME[text.upper()].offset
    return number(text, "a register (by its name or offset)", 0, 0xFFFF_FFFF)


def _register_line(offset: int, value: int, block: int) -> str:
    register = BY_OFFSET.get(offset) if block == 0 else None
    if register is None:
        return f"{offset:#06x} = {value:#010x}"
    return f"{register.name:<6} {offset:#04x} = {value:#010x}  {register.describe(value)}".rstrip()


def _read(session: Session, rest: list[str], block: int) -> Iterator[str]:
    if rest[0] == "all":
        for register in BY_NAME.values():
            if register.readable:
                reply = session.command(Command.READ, commands.read_arguments(0, register.offset, 1))
                if reply.status == 0:
                    yield _register_line(register.offset, commands.read_results(reply)[0], 0)
        return
    offset = _offset(rest[0], block)
    count = number(rest[1], "the number of registers", 1, commands.MOST_REGISTERS) if len(rest) > 1 else 1
    for place, value in enumerate(session.read_registers(offset, count, block)):
        yield _register_line(offset + place * (4 if block == 0 else 1), value, block)


def _write(session: Session, rest: list[str], block: int) -> Iterator[str]:
    offset, value = _offset(rest[0], block), number(rest[1], "a register's value", 0, 0xFFFF_FFFF)
    session.write_register(offset, value, block)
    yield _register_line(offset, value, block)


def _heartbeat(session: Session, _: list[str], __: int) -> Iterator[str]:
    session.demand(Command.HEARTBEAT)
    _wait(session, lambda: session.receiver.heartbeat is not None)
    beat = session.receiver.heartbeat
    if beat is None:
        raise CommandError("the device answered, but its HEARTBEAT did not come")
    yield f"state {beat.state_name}, last time-out: {beat.cause_name}, up {beat.uptime / 1e6:.1f} s"
    for name in ("delivered", "dropped", "lost", "skipped", "overruns", "sync_errors", "dma_errors", "lines_dropped"):
        yield f"{name.replace('_', ' ')}: {getattr(beat, name):,}"
    for name in ("packets_sent", "bytes_sent", "packets_unsent", "packets_received", "packets_damaged"):
        yield f"{name.replace('_', ' ')}: {getattr(beat, name):,}"


def _wait(session: Session, ready: Callable[[], bool], seconds: float = 1.0) -> None:
    until = session.source.now() + seconds
    while not ready() and session.source.now() < until:
        session.ended.wait(0.01)


_REQUESTS: dict[str, tuple[Callable[[Session, list[str], int], Iterator[str]], int, int]] = {
    "ping": (_ping, 0, 0),
    "hello": (_hello, 0, 0),
    "start": (_simple(Command.START, "started"), 0, 0),
    "stop": (_simple(Command.STOP, "stopped"), 0, 0),
    "snapshot": (_snapshot, 0, 1),
    "streams": (_streams, 1, 1),
    "encoding": (_encoding, 2, 2),
    "stages": (_stages, 1, 2),
    "get": (_get, 0, 1),
    "set": (_set, 2, 2),
    "read": (_read, 1, 2),
    "write": (_write, 2, 2),
    "heartbeat": (_heartbeat, 0, 0),
}
