"""The command `camif-inspect`.

Exit status: 0 fine, 1 a frame was not whole or the device refused, 2 bad usage or input, with one clear line.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, DownloadColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from . import statistics
from .arguments import parser
from .ask import ask
from .errors import CommandError, InspectError, RequestError
from .files import replacing
from .play import channel_at, play
from .port import RecordedSource, Source, source_for
from .recording import RecordingWriter
from .save import KINDS, save_frame, sentence, stem, summary
from .session import Session

_OTHER_PICTURES = {".jpg", ".jpeg", ".bmp", ".gif", ".tif", ".tiff", ".webp", ".ppm", ".pgm", ".pnm"}
_errors = Console(stderr=True, highlight=False, soft_wrap=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; gives the exit status."""
    options = parser().parse_args(arguments)
    try:
        return int(_VERBS[options.verb](options))
    except CommandError as error:
        print(f"camif-inspect: {error}", file=sys.stderr)
        return 2 if isinstance(error, RequestError) else 1
    except InspectError as error:
        print(f"camif-inspect: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        # Whoever read our output has seen enough.
        sys.stderr.close()
        return 0
    except KeyboardInterrupt:
        print("camif-inspect: interrupted", file=sys.stderr)
        return 130


def _session(
    options: argparse.Namespace, speed: float | None = None, recorder: RecordingWriter | None = None
) -> Session:
    session = Session(source_for(options.url, options.baud, speed), options.wait, recorder)
    if session.trouble:
        _warn(f"{session.trouble}; waiting for it")
        while session.trouble and not session.ended.wait(0.05):
            pass
    return session


def _warn(text: str) -> None:
    _errors.print(text, style="yellow", markup=False)


def _progress(*columns: TextColumn | BarColumn | MofNCompleteColumn | DownloadColumn | TimeElapsedColumn) -> Progress:
    return Progress(
        TextColumn("{task.description}", markup=False),
        *columns,
        TimeElapsedColumn(),
        console=_errors,
        transient=True,
        disable=not _errors.is_terminal,  # it would leave an empty line in a file
    )


class _LogPrinter:
    """Prints what the session has to say as it says it; the device's log only from warnings on."""

    def __init__(self, session: Session, everything: bool = False) -> None:
        self._session = session
        self._seen = 0
        self._everything = everything

    def __call__(self, console: Console) -> None:
        lines, self._seen = self._session.said_since(self._seen)
        for _, level, text in lines:
            if self._everything or level in ("error", "warning"):
                console.print(f"{level}: {text}", style="red" if level == "error" else "yellow", markup=False)


def _stream_of(text: str | None) -> int | str | None:
    return int(text) if text is not None and text.isdigit() else text


def _save(options: argparse.Namespace) -> int:
    kinds = KINDS if options.kind == "both" else (options.kind,)
    single = options.out.suffix[1:] if options.out.suffix[1:] in KINDS else None
    if single and options.kind not in (single, "both"):
        raise InspectError(f"{options.out} is a .{single} file, and --kind asks for {options.kind}")
    if single is None and options.out.suffix.lower() in _OTHER_PICTURES and not options.out.is_dir():
        raise InspectError(f"{options.out}: a picture is written as .png, or its bytes as .raw; or name a directory")
    if single and options.frames != 1:
        raise InspectError(f"{options.out} is one file, and {options.frames} frames are asked for; name a directory")
    saved: list[dict[str, object]] = []
    all_whole = True
    with _session(options) as session, _progress(BarColumn(), MofNCompleteColumn()) as progress:
        print_log = _LogPrinter(session)
        task = progress.add_task("frames", total=options.frames)
        if session.source.live:
            # Files are named after streams.
            session.introduced()
        lines = progress.add_task("lines of the next", total=None, visible=session.source.live)

        def show_lines() -> None:
            with session.lock:
                arriving = [stream.open for stream in session.receiver.streams.values() if stream.open]
            if arriving:
                frame = arriving[0]
                progress.update(lines, total=frame.height, completed=int(frame.present.sum()))
            print_log(progress.console)

        for frame in session.frames(_stream_of(options.stream), options.timeout, show_lines):
            if frame.missing.any() and session.source.live and not options.no_resend:
                try:
                    session.request_missing(frame)
                except InspectError as error:
                    progress.console.print(f"missing lines were not sent again: {error}", style="yellow", markup=False)
            if options.whole and not frame.whole:
                progress.console.print(f"passed over {sentence(frame)}", style="yellow", markup=False)
                continue
            files = [options.out] if single else [options.out / f"{stem(frame)}.{kind}" for kind in kinds]
            for path in files:
                save_frame(frame, path, path.suffix[1:])
            all_whole &= frame.whole
            saved.append(summary(frame) | {"files": [str(path) for path in files]})
            if not options.json:
                style = "" if frame.whole else "yellow"
                progress.console.print(f"{', '.join(map(str, files))}: {sentence(frame)}", style=style, markup=False)
            progress.advance(task)
            if len(saved) == options.frames:
                break
        print_log(progress.console)
    if options.json:
        print(json.dumps({"frames": saved}))
    if len(saved) < options.frames:
        raise InspectError(f"{options.url} ended after {len(saved)} of {options.frames} frames")
    return 0 if all_whole else 1


def _record(options: argparse.Namespace) -> int:
    with replacing(options.out, buffering=0) as file:
        writer = RecordingWriter(file)
        with _session(options, recorder=writer) as session:
            until = time.monotonic() + options.seconds if options.seconds else math.inf
            print_log = _LogPrinter(session)
            try:
                with _progress(DownloadColumn()) as progress:
                    task = progress.add_task(f"recording to {options.out}", total=None)
                    while time.monotonic() < until and not session.ended.is_set() and writer.failure is None:
                        time.sleep(0.05)
                        progress.update(task, completed=writer.bytes_written)
                        print_log(progress.console)
                    print_log(progress.console)
            except KeyboardInterrupt:
                # The usual way to end it: what has come is kept.
                pass
            session.record(None)
            session.check()
        written = writer.bytes_written
    _errors.print(f"{options.out}: {written:,} bytes", markup=False)
    if writer.failure is not None:
        raise InspectError(f"{options.out} ends early, but is good up to there: {writer.failure.strerror}")
    return 0


def _play(options: argparse.Namespace) -> int:
    source = RecordedSource(options.file, options.speed, options.loop)
    progress = _progress(BarColumn(), DownloadColumn())

    def announce(url: str) -> None:
        print(url, flush=True)
        progress.console.print("waiting for a listener, such as: camif-inspect view " + url, markup=False)

    channel = channel_at(options.to, announce)
    with progress:
        task = progress.add_task(f"playing {options.file}", total=None if options.loop else source.reader.size)
        played = play(source, channel, lambda at: progress.update(task, completed=at))
    _errors.print(f"{played:,} bytes played")
    if source.reader.cut_short:
        _warn(f"{options.file} is cut short within a record; all before that was played")
    return 0


def _stats(options: argparse.Namespace) -> int:
    with _session(options) as session:
        print_log = _LogPrinter(session)
        first = statistics.sample(session.receiver, session.source.now())
        session.start()
        until = time.monotonic() + options.seconds
        with _progress(BarColumn()) as progress:
            task = progress.add_task("listening", total=options.seconds if session.source.live else None)
            while not session.ended.is_set() and (not session.source.live or time.monotonic() < until):
                time.sleep(0.05)
                progress.update(task, completed=options.seconds - (until - time.monotonic()))
                print_log(progress.console)
            # What was said after the last look.
            print_log(progress.console)
        session.check()
        with session.lock:
            last = statistics.sample(session.receiver, session.source.now())
            everything = statistics.as_json(first, last, session.receiver)
        noisy, hint = session.noisy, session.noise_hint
    if options.json:
        print(json.dumps(everything))
    else:
        Console(highlight=False).print(_table(everything))
    if not everything["counts"]["received"]:
        if everything["other_versions"]:
            return 1
        if noisy or everything["counts"]["damaged"]:
            raise InspectError(f"bytes came and no packet: {hint}")
        if not everything["counts"]["bytes"]:
            raise InspectError(f"not a byte came from {options.url}")
    return 0


def _table(everything: dict[str, Any]) -> Table:
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(justify="left")
    table.add_column(justify="right")
    table.add_column(justify="left", style="dim")
    counts = everything["counts"]
    table.add_row("bytes", f"{counts['bytes']:,}", f"{everything['bytes_per_second']:,.0f} a second")
    for stream in everything["streams"]:
        rate = f"{stream['frames_per_second']:.2f} frames a second"
        table.add_row(f"frames of {stream['name']}", f"{stream['frames']:,}", rate)
    table.add_row("frames whole", f"{counts['frames_whole']:,}", f"of {counts['frames']:,}")
    notes = {
        "frames_bad_verdict": "the capture was bad",
        "frames_bad_crc": "a fault of the device",
        "frames_endless": "their end was lost",
        "lines": "put in their places",
        "lines_lost": "by the link",
        "unfit": "lines that fit nowhere",
        "received": "packets",
        "damaged": "packets: CRC errors and the like",
        "malformed": "packets",
        "other_version": "packets of another protocol version",
        "unknown_kind": "packets",
    }
    for name, note in notes.items():
        table.add_row(name.replace("_", " "), f"{counts[name]:,}", note)
    device = everything["device"]
    if device:
        note = "" if device["cause"] == "none" else f"last time-out: {device['cause']}"
        table.add_row("device", device["state"], note)
        for name in ("delivered", "dropped", "lost", "overruns", "packets_unsent", "packets_damaged"):
            table.add_row(f"  {name.replace('_', ' ')}", f"{device[name]:,}", "since its start")
    return table


def _command(options: argparse.Namespace) -> int:
    if options.request[0] == "help":
        print(ask.__doc__)
        return 0
    with _session(options) as session:
        for line in ask(session, options.request, options.block):
            print(line)
    return 0


def _view(options: argparse.Namespace) -> int:
    if (options.url is None) == (options.play is None):
        raise InspectError("view shows either a URL or, with --play, a recording")
    from .view import serve  # only here: it takes asyncio and a web server along

    source: Source
    if options.play is not None:
        source = RecordedSource(options.play, options.speed, options.loop)
    else:
        source = source_for(options.url, options.baud, options.speed, options.loop)
    with Session(source, wait=True) as session:
        if session.trouble:
            _warn(f"{session.trouble}; waiting for it")
        serve(session, options.host, options.port, options.save_to, not options.no_browser)
    return 0


_VERBS = {
    "view": _view,
    "save": _save,
    "record": _record,
    "play": _play,
    "stats": _stats,
    "command": _command,
}
