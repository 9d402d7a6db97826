"""A device in Python, made from the protocol's page: what the tests talk to.

It shares no code with the package: packets come from the generator of the test vectors.
"""

from __future__ import annotations

import importlib.util
import os
import pty
import socket
import struct
import threading
import time
import tty
import zlib
from pathlib import Path

import numpy as np
from cobs import cobs

_PATH = Path(__file__).parents[2] / "tests" / "data" / "link" / "generate.py"
_SPEC = importlib.util.spec_from_file_location("link_vectors", _PATH)
link = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(link)

RAW = 0
GRAY8 = 4
RGB888 = 1


def wire(body: bytes) -> bytes:
    return cobs.encode(body) + b"\0"


def frame_packets(stream, sequence, code, pixels, encoding=RAW, verdict=0, meaning=0, palette_crc=0):
    """The packets of a frame: FRAME, a LINE for each line, END, each as it goes over the wire."""
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels).reshape(height, -1).view(np.uint8)
    data = rows.tobytes()
    packets = [link.frame(stream, code, meaning, 0, sequence, width, height, 1000 * sequence, palette_crc)]
    for number, row in enumerate(rows):
        payload, unused = link.encoded(row.tobytes(), code, encoding)
        packets.append(link.line(stream, code, encoding, sequence, number, 0, payload, unused))
    captured = (height, rows.shape[1], rows.shape[1], len(data))
    crc = zlib.crc32(data)
    packets.append(link.end(stream, code, verdict, height, sequence, width, height, captured, 0, 0, 0, len(data), crc))
    return [wire(packet) for packet in packets]


def frame_wire(*arguments, **options) -> bytes:
    return b"".join(frame_packets(*arguments, **options))


class Device:
    """Plays a device to one host at a time.

    `pictures` has for each stream (name, format code, encoding, function from a frame's number to its pixels).
    """

    def __init__(self, pictures, interval=0.05, session=7, name="test device 1", running=True, keep=4):
        self.pictures = pictures
        self.interval = interval
        self.session = session
        self.name = name
        self.running = running
        self.frames_left = None
        self.on = (1 << len(pictures)) - 1
        self.sequence = 0
        self.commands = []
        self.registers = dict.fromkeys(link_registers(), 0) | {0x00: 0x40E3, 0x04: 0x3, 0x0C: 0x1F}
        self.parameters = [["exposure", 100, 1, 1000], ["gain", 16, 0, 255]]
        self.pipelines = ["" for _ in pictures]
        self.lose = set()
        self.kept = {}
        self.keep = keep
        self.version = 1
        self._last = (None, b"")
        self._send = None
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._threads = []

    # Lines of communication.

    def on_tcp(self):
        """Listen; give the URL."""
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(0.1)
        self._start(self._serve_tcp)
        return f"socket://127.0.0.1:{self._listener.getsockname()[1]}"

    def on_pty(self):
        """Open a pseudo-terminal; give its path."""
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self._start(lambda: self._talk(lambda: os.read(self._master, 4096), self._write_pty))
        return os.ttyname(self._slave)

    def _write_pty(self, data):
        while data and not self._stop.is_set():
            data = data[os.write(self._master, data) :]

    def _start(self, target):
        thread = threading.Thread(target=target, daemon=True)
        self._threads.append(thread)
        thread.start()

    def _serve_tcp(self):
        while not self._stop.is_set():
            try:
                connection, _ = self._listener.accept()
            except TimeoutError:
                continue
            except OSError:
                return
            self.connection = connection
            with connection:
                self._talk(lambda: connection.recv(4096), connection.sendall)  # noqa: B023

    def hang_up(self):
        """Cut the connection, as a pulled cable does; the next one is served anew."""
        self.connection.shutdown(socket.SHUT_RDWR)

    def close(self):
        self._stop.set()
        if hasattr(self, "_listener"):
            self._listener.close()
            if hasattr(self, "connection"):
                self.connection.close()
        if hasattr(self, "_master"):
            os.close(self._slave)
            os.close(self._master)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # What it says.

    def _talk(self, read, write):
        gone = threading.Event()

        def send(data):
            with self._lock:
                write(data)

        def frames():
            try:
                self._announce(send)
                beat = 0.0
                while not gone.is_set() and not self._stop.is_set():
                    if time.monotonic() - beat > 1:
                        beat = time.monotonic()
                        send(self._of_version(self.heartbeat()))
                        for number in range(len(self.pictures)):
                            send(self._of_version(self.stream(number)))
                    if self.running and self.version == 1:
                        self._frame(send)
                    time.sleep(self.interval)
            except OSError:
                gone.set()

        thread = threading.Thread(target=frames, daemon=True)
        thread.start()
        pending = b""
        try:
            while not gone.is_set() and not self._stop.is_set():
                data = read()
                if not data:
                    break
                *whole, pending = (pending + data).split(b"\0")
                for piece in filter(None, whole):
                    self._command(cobs.decode(piece), send)
        except OSError:
            pass
        gone.set()
        thread.join(2)

    def _announce(self, send):
        send(b"\0" + self._of_version(link.hello(*self._hello())))
        for number in range(len(self.pictures)):
            send(self._of_version(self.stream(number)))
        send(self._of_version(link.log(3, 0, 0, 1000, f"{self.name} is up")))

    def _of_version(self, body):
        if self.version != 1:
            body = bytearray(body[:-4])
            body[0] = self.version
            if body[1] == 1:
                body[9] = self.version
            body += struct.pack("<I", zlib.crc32(body))
        return wire(bytes(body))

    def _hello(self):
        return self.session, self.name, len(self.pictures)

    def stream(self, number):
        name, code, encoding, make = self.pictures[number]
        height, width = make(0).shape[:2]
        on = self.on >> number & 1
        return link.stream(number, code, encoding, on, width, height, 0, self.pipelines[number], name)

    def heartbeat(self):
        values = [self.session, 1_000_000, self.sequence, 0, 0, 0, 0, 0, 0, 0, 5, 1000, 0, 1, 0, 921_600, 0, 0]
        values[16] = int(self.running)
        return link.heartbeat(values)

    def _frame(self, send):
        self.sequence += 1
        for number, (_, code, encoding, make) in enumerate(self.pictures):
            if not self.on >> number & 1:
                continue
            packets = frame_packets(number, self.sequence, code, make(self.sequence), encoding)
            self.kept[number, self.sequence] = packets
            self.kept.pop((number, self.sequence - self.keep), None)
            for place, packet in enumerate(packets):
                if (self.sequence, place - 1) not in self.lose:
                    send(packet)
        if self.frames_left is not None:
            self.frames_left -= 1
            if self.frames_left <= 0:
                self.running, self.frames_left = False, None

    # What it is told.

    def _command(self, body, send):
        if zlib.crc32(body) != 0x2144DF1C:
            return
        if body[0] != self.version:
            send(self._of_version(link.hello(*self._hello())))
            return
        if body == self._last[0]:
            send(self._last[1])
            return
        request, command = struct.unpack_from("<HB", body, 4)
        arguments = body[8:-4]
        self.commands.append((command, arguments))
        after = []
        status, rest = self._do(command, arguments, after)
        answer = wire(link.reply(request, command, status, rest))
        self._last = (body, answer)
        send(answer)
        for packet in after:
            send(packet)

    def _do(self, command, arguments, after):
        if command == 0:
            return 0, arguments
        if command == 1:
            after.append(wire(link.hello(*self._hello())))
            after += [wire(self.stream(number)) for number in range(len(self.pictures))]
            return 0, b""
        if command in (2, 3):
            self.running = command == 2
            after.append(wire(link.log(3, 0, 0, 2000, "started" if self.running else "stopped")))
            after.append(wire(self.heartbeat()))
            return 0, b""
        if command == 4:
            (self.frames_left,) = struct.unpack("<H", arguments)
            self.running = True
            return 0, arguments
        if command == 5:
            (self.on,) = struct.unpack("<I", arguments)
            after += [wire(self.stream(number)) for number in range(len(self.pictures))]
            return 0, arguments
        if command == 6:
            number, encoding = arguments
            for place in range(len(self.pictures)) if number == 255 else [number]:
                name, code, _, make = self.pictures[place]
                self.pictures[place] = (name, code, encoding, make)
            return 0, arguments
        if command == 7:
            text = arguments[4:].decode()
            if "cany" in text:
                return 3, b"no stage `cany`; is it `canny`?"
            self.pipelines[arguments[0]] = text
            after.append(wire(self.stream(arguments[0])))
            return 0, arguments
        if command in (8, 9):
            (place,) = struct.unpack_from("<H", arguments)
            if place >= len(self.parameters):
                return 3, b"no such parameter"
            name, value, least, most = self.parameters[place]
            if command == 8:
                (wanted,) = struct.unpack_from("<i", arguments, 4)
                if not least <= wanted <= most:
                    return 3, f"{name} is {least} to {most}".encode()
                self.parameters[place][1] = value = wanted
            return 0, struct.pack("<HHiii", place, 0, value, least, most) + name.encode()
        if command == 10:
            block, number, _, offset = struct.unpack("<BBHI", arguments)
            offsets = [offset + 4 * place for place in range(number)]
            if block or any(place not in self.registers for place in offsets):
                return 7, f"no register at {offset:#04x}".encode()
            return 0, arguments + struct.pack(f"<{number}I", *[self.registers[place] for place in offsets])
        if command == 11:
            _, offset, value = struct.unpack("<B3xII", arguments)
            if offset not in self.registers:
                return 7, f"no register at {offset:#04x}".encode()
            self.registers[offset] = value
            return 0, arguments
        if command == 12:
            stream, first, sequence, count = struct.unpack("<BxHIH", arguments)
            packets = self.kept.get((stream, sequence))
            if packets is None:
                return 8, b"the frame is no longer held"
            for packet in packets[1 + first : 1 + first + count]:
                body = bytearray(cobs.decode(packet[:-1])[:-4])
                body[7] |= 1
                after.append(wire(bytes(body) + struct.pack("<I", zlib.crc32(body))))
            return 0, struct.pack("<H", len(after))
        if command == 13:
            after.append(wire(self.heartbeat()))
            return 0, b""
        return 1, b"no such command"


def link_registers():
    return [*range(0x00, 0x2C, 4), *range(0x40, 0x50, 4), *range(0x60, 0x78, 4)]
