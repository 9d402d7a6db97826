"""Bytes of the link become frames, log and statistics.

Pure: no port, no clock, no thread. Whatever is lost, hit, doubled or put in, every undamaged packet is used and no
pixel is put anywhere but in its own place; a receiver is in step again at the next delimiter.

Lines are most of what comes, so they take a short way: lines of one frame that arrive together are checked one by one
(stuffing and CRC, both in C), and decoded and put in their places together, by numpy.
"""

from __future__ import annotations

import zlib
from collections import Counter

import numpy as np
from cobs import cobs

from . import encodings
from .counts import Counts
from .formats import FORMATS, INDEX8, Bytes, PixelFormat
from .frame import Frame, Placement
from .packet import (
    CRC_RESIDUE,
    DELIMITER,
    LARGEST_WIRE,
    LEAST_BODY,
    VERSION,
    FrameEnd,
    FrameStart,
    Heartbeat,
    Hello,
    Kind,
    Log,
    Malformed,
    OtherVersion,
    Palette,
    Reply,
    StreamInfo,
    UnknownKind,
    parse,
)
from .stream import Stream, after, is_numbered

Event = Hello | StreamInfo | Palette | Frame | Heartbeat | Log | Reply | OtherVersion

# Closed frames kept for lines that are sent again.
_KEPT_FRAMES = 2
_LINE_HEAD = 14
_LINE_KIND = bytes((VERSION, Kind.LINE))
_LINE_BEGINS = int.from_bytes(_LINE_KIND, "little")
_HALF = 1 << 15


class Receiver:
    """Takes bytes as they come, in pieces of any length, and gives what they mean."""

    def __init__(self, joins_midway: bool = False) -> None:
        """Start with nothing. With `joins_midway` the piece up to the first delimiter may be the end of a packet."""
        self.counts = Counts()
        self.versions: Counter[int] = Counter()
        self.streams: dict[int, Stream] = {}
        self.palettes: dict[int, bytes] = {}
        self.hello: Hello | None = None
        self.session: int | None = None
        self.heartbeat: Heartbeat | None = None
        self._tail = b""
        self._overlong = False
        self._joining = joins_midway
        self._events: list[Event] = []

    def rejoin(self) -> None:
        """Start anew in the middle of the stream, as after a lost connection; what is known stays known."""
        self._tail = b""
        self._overlong = False
        self._joining = True

    def feed(self, data: bytes) -> list[Event]:
        """Take bytes; give the events that they complete, in order."""
        self.counts.bytes += len(data)
        pieces = (self._tail + data if self._tail else data).split(DELIMITER)
        self._tail = pieces.pop()
        if self._overlong and pieces:
            # The rest of what was too long, and was counted then.
            pieces[0] = b""
            self._overlong = False
        if len(self._tail) > LARGEST_WIRE:
            self.counts.damaged += not self._overlong
            self._overlong = True
        if self._overlong:
            self._tail = b""
        if self._joining and pieces:
            self._joining = False
            self._first(pieces)

        self._take_bodies(self._bodies(list(filter(None, pieces))))
        events, self._events = self._events, []
        return events

    def _bodies(self, pieces: list[bytes]) -> list[bytes]:
        """Undo the stuffing and check the CRC: gives the packets that are not damaged, and counts the others.

        All that happens to each packet by itself happens here, and none of it in Python as long as none is damaged.
        """
        if not pieces:
            return []
        try:
            bodies = list(map(cobs.decode, pieces))
            lengths = list(map(len, pieces))
            whole = list(map(zlib.crc32, bodies)).count(CRC_RESIDUE) == len(bodies)
            if whole and min(lengths) > LEAST_BODY and max(lengths) <= LARGEST_WIRE:
                return bodies
        except cobs.DecodeError:
            pass
        return [body for body in map(self._body, pieces) if body is not None]

    def _body(self, wire: bytes) -> bytes | None:
        """Undo the stuffing of one packet and check its CRC; None, and counted, if it is damaged."""
        try:
            body: bytes = cobs.decode(wire)
        except cobs.DecodeError:
            body = b""
        if len(body) < LEAST_BODY or len(wire) > LARGEST_WIRE or zlib.crc32(body) != CRC_RESIDUE:
            self.counts.damaged += 1
            return None
        return body

    def _take_bodies(self, bodies: list[bytes]) -> None:
        """Take packets in their order, but lines that follow each other together."""
        if not bodies:
            return
        heads = np.frombuffer(b"".join([body[:_LINE_HEAD].ljust(_LINE_HEAD) for body in bodies]), np.uint8)
        heads = heads.reshape(-1, _LINE_HEAD)
        lengths = np.array(list(map(len, bodies)))
        words = heads.view("<u2")
        # Whole lines of the length that they say they have. Pieces of lines come one by one.
        plain = (words[:, 0] == _LINE_BEGINS) & (words[:, 6] == 0) & (words[:, 1] == lengths - LEAST_BODY)
        plain &= lengths >= _LINE_HEAD + 4
        begin = 0
        for place in [*np.flatnonzero(~plain).tolist(), len(bodies)]:
            if begin < place:
                self._take_lines(bodies[begin:place], heads[begin:place])
            begin = place + 1
            if place < len(bodies):
                self._packet(bodies[place])

    def _take_lines(self, bodies: list[bytes], heads: Bytes) -> None:
        """Take whole lines: those with stream, format, encoding and frame in common together, for these take turns.

        Only another frame of a stream comes after what is of the one before.
        """
        words = heads.view("<u2")
        keys = words[:, 2].astype(np.int64) | words[:, 3].astype(np.int64) << 16 | words[:, 4].astype(np.int64) << 32
        if np.all(keys == keys[0]):
            self._take_batch(bodies, heads)
            return
        batches: dict[int, list[int]] = {}

        def take() -> None:
            for places in batches.values():
                self._take_batch([bodies[place] for place in places], heads[places])
            batches.clear()

        for place, key in enumerate(keys.tolist()):
            if key not in batches:
                if any(key & 255 == other & 255 and key >> 32 != other >> 32 for other in batches):
                    take()
                batches[key] = []
            batches[key].append(place)
        take()

    def _first(self, pieces: list[bytes]) -> None:
        """Forgive the first piece after joining midway if it is only the end of a packet."""
        try:
            body = cobs.decode(pieces[0])
        except cobs.DecodeError:
            body = b""
        if pieces[0] and (len(body) < LEAST_BODY or zlib.crc32(body) != CRC_RESIDUE):
            self.counts.fragments += 1
            pieces[0] = b""

    def _packet(self, body: bytes) -> None:
        """Take a body whose CRC is right, and which is no plain line."""
        if body[:2] == _LINE_KIND and len(body) >= _LINE_HEAD + 4:
            self._take_batch([body], np.frombuffer(body[:_LINE_HEAD], np.uint8).reshape(1, -1))
            return
        try:
            packet = parse(body)
        except Malformed:
            self.counts.malformed += 1
            return
        if isinstance(packet, OtherVersion):
            self.counts.other_version += 1
            self.versions[packet.version] += 1
            self._events.append(packet)
        elif isinstance(packet, UnknownKind):
            self.counts.unknown_kind += 1
        else:
            self.counts.received += 1
            self._take(packet)

    def _take(self, packet: object) -> None:
        if isinstance(packet, Hello):
            self._session(packet.session, hello=True)
            self.hello = packet
        elif isinstance(packet, StreamInfo):
            stream = self._stream(packet.stream)
            stream.info = packet
            if stream.open is not None:
                stream.open.name = packet.name
            stream.size, stream.meaning = (packet.width, packet.height), packet.meaning
        elif isinstance(packet, Palette):
            self._palette(packet)
        elif isinstance(packet, FrameStart):
            self._frame_starts(packet)
            return
        elif isinstance(packet, FrameEnd):
            self._frame_ends(packet)
            return
        elif isinstance(packet, Heartbeat):
            self._session(packet.session)
            self.heartbeat = packet
        if isinstance(packet, Hello | StreamInfo | Palette | Heartbeat | Log | Reply):
            self._events.append(packet)

    # Streams and frames.

    def _stream(self, number: int) -> Stream:
        if number not in self.streams:
            self.streams[number] = Stream(number)
        return self.streams[number]

    def _session(self, session: int, hello: bool = False) -> None:
        """Notice a device that has started anew: its frame numbers begin again."""
        if self.session != session and (hello or self.session is not None):
            for stream in self.streams.values():
                self._close(stream, None)
                stream.kept.clear()
                stream.last_sequence = None
        self.session = session

    def _palette(self, palette: Palette) -> None:
        self.palettes[palette.crc] = palette.colors
        while len(self.palettes) > 64:
            del self.palettes[next(iter(self.palettes))]
        for frame in self._frames(self._stream(palette.stream)):
            if frame.palette is None and frame.palette_crc == palette.crc and frame.format.code == INDEX8:
                frame.palette = palette.colors
                frame.changes += 1

    @staticmethod
    def _frames(stream: Stream) -> list[Frame]:
        return [*stream.kept, stream.open] if stream.open else list(stream.kept)

    def _open(self, stream: Stream, sequence: int, code: int, size: tuple[int, int], meaning: int) -> Frame:
        self._close(stream, None)
        frame = Frame(stream.number, sequence, FORMATS[code], *size, meaning=meaning)
        frame.name = stream.info.name if stream.info else ""
        stream.open = frame
        stream.last_sequence = sequence
        return frame

    def _close(self, stream: Stream, end: FrameEnd | None) -> None:
        frame = stream.open
        if frame is None:
            return
        frame.close(end)
        stream.open = None
        stream.kept = [*stream.kept, frame][-_KEPT_FRAMES:]
        stream.frames += 1
        counts = self.counts
        counts.frames += 1
        counts.frames_whole += frame.whole
        counts.frames_bad_verdict += end is not None and end.verdict != 0
        counts.frames_bad_crc += frame.crc_ok is False
        counts.frames_endless += end is None
        frame.lost_counted = frame.lost_lines
        counts.lines_lost += frame.lost_counted
        self._events.append(frame)

    def _frame_starts(self, start: FrameStart) -> None:
        if start.format not in FORMATS:
            return
        stream = self._stream(start.stream)
        frame = stream.open
        size = (start.width, start.height)
        if frame is not None and is_numbered(frame, start.sequence) and frame.format.code == start.format:
            frame.sequence, frame.sequence_known = start.sequence, True
            stream.last_sequence = start.sequence
        else:
            if stream.last_sequence is not None and after(start.sequence, stream.last_sequence) <= 0:
                # The beginning of a frame that is over, or open already, once more.
                return
            frame = self._open(stream, start.sequence, start.format, size, start.meaning)
        frame.resize(*size)
        frame.meaning = start.meaning
        frame.captured_at = start.captured_at
        frame.snapshot = start.snapshot
        frame.palette_crc = start.palette_crc
        if start.format == INDEX8:
            frame.palette = self.palettes.get(start.palette_crc)
        frame.changes += 1
        stream.size, stream.meaning = size, start.meaning

    def _frame_ends(self, end: FrameEnd) -> None:
        stream = self._stream(end.stream)
        stream.size = (end.width, end.height)
        if stream.open is not None and is_numbered(stream.open, end.sequence):
            stream.open.sequence = stream.last_sequence = end.sequence
        else:
            if end.format not in FORMATS:
                return
            if stream.last_sequence is not None and after(end.sequence, stream.last_sequence) <= 0:
                for frame in stream.kept:
                    if is_numbered(frame, end.sequence) and frame.end is None:
                        self.counts.frames_endless -= 1
                        self.counts.frames_bad_verdict += end.verdict != 0
                        frame.close(end)
                        self._repaired(frame)
                return
            # Not a line of it has come: a frame all of whose lines are missing.
            self._open(stream, end.sequence, end.format, stream.size, stream.meaning)
        self._close(stream, end)

    # Lines.

    def _take_batch(self, batch: list[bytes], heads: Bytes) -> None:
        """Take lines of one frame that have format and encoding in common."""
        code, encoding, unused = batch[0][5], batch[0][6] & 15, batch[0][6] >> 4 & 7
        pixel_format = FORMATS.get(code)
        if pixel_format is None or encoding not in encodings.NAMES or encoding == encodings.SENDER_CHOOSES:
            # Of a later edition of this version: ignored, but a packet all the same.
            self.counts.received += len(batch)
            self.counts.unfit += len(batch)
        elif len(batch) == 1 or not self._lines(batch, heads, pixel_format, encoding, unused):
            for body in batch:
                self._line(body, pixel_format, encoding, unused)

    def _lines(self, batch: list[bytes], heads: Bytes, pixel_format: PixelFormat, encoding: int, unused: int) -> bool:
        """Take a batch whole; False, and nothing done, if it is not as plain as batches are."""
        count = len(batch)
        words = heads.view("<u2")
        try:
            if encoding == encodings.RAW and np.all(words[:, 1] == words[0, 1]):
                rows = np.frombuffer(b"".join(batch), np.uint8).reshape(count, -1)[:, _LINE_HEAD:-4]
            else:
                payloads = [body[_LINE_HEAD:-4] for body in batch]
                pixels, counts = encodings.decode(encoding, unused, payloads, pixel_format)
                if np.any(counts != counts[0]):
                    return False
                rows = pixels.reshape(count, -1)
        except Malformed:
            return False
        frame = self._frame_of_line(batch[0])
        if frame is None or frame.format is not pixel_format or not frame.put_lines(words[:, 5].astype(np.int64), rows):
            return False
        self.counts.received += count
        self.counts.lines += count
        if frame.closed:
            self._repaired(frame)
        return True

    def _line(self, body: bytes, pixel_format: PixelFormat, encoding: int, unused: int) -> None:
        """Take one line, or a piece of one."""
        payload = body[_LINE_HEAD:-4]
        if body[2] | body[3] << 8 != len(body) - LEAST_BODY or (unused and not payload):
            self.counts.malformed += 1
            return
        self.counts.received += 1
        try:
            pixels, _ = encodings.decode(encoding, unused, [payload], pixel_format)
        except Malformed:
            self.counts.unfit += 1
            return
        frame = self._frame_of_line(body)
        line, first = body[10] | body[11] << 8, body[12] | body[13] << 8
        if frame is None or frame.format is not pixel_format:
            self.counts.unfit += 1
            return
        placement = frame.put_piece(line, first, pixels)
        self.counts.lines += placement is Placement.PUT
        self.counts.unfit += placement is Placement.UNFIT
        if placement is Placement.PUT and frame.closed:
            self._repaired(frame)

    def _frame_of_line(self, head: bytes) -> Frame | None:
        """Find the frame that a line belongs to by the low 16 bits of its number; a newer one begins here."""
        stream = self._stream(head[4])
        low = head[8] | head[9] << 8
        if stream.open is not None and stream.open.sequence & 0xFFFF == low:
            return stream.open
        last = stream.last_sequence
        distance = 1 if last is None else (low - last + _HALF) % (2 * _HALF) - _HALF
        if distance <= 0:
            kept = (frame for frame in stream.kept if frame.sequence & 0xFFFF == low)
            return next(kept, None)
        if stream.size is None:
            return None
        frame = self._open(stream, low if last is None else last + distance, head[5], stream.size, stream.meaning)
        frame.sequence_known = last is not None
        return frame

    def _repaired(self, frame: Frame) -> None:
        """Count a frame that is over anew, after lines of it were sent again."""
        was_whole, was_bad = frame.crc_ok is not None and frame.whole, frame.crc_ok is False
        frame.check()
        self.counts.frames_whole += frame.whole - was_whole
        self.counts.frames_bad_crc += (frame.crc_ok is False) - was_bad
        self.counts.lines_lost += frame.lost_lines - frame.lost_counted
        frame.lost_counted = frame.lost_lines
