#!/usr/bin/env python3
"""Makes the captures of this folder that other programs than ours write, from one picture of 24 x 4 samples, two frames.

    python3 make.py            needs sigrok-cli for the .sr, vcd2fst (GTKWave) for the .fst; only the standard library otherwise

The binary files follow Saleae's published descriptions of versions 0 and 1 and share no code with the reader.
"""
import os
import struct
import subprocess
import tempfile

LINE, LINES, FRAMES = 24, 4, 2
RATE, PCLK = 96_000_000, 12_000_000  # 8 samples a clock


def clocks():
    """(HSYNC, VSYNC, data) a pixel clock: HSYNC at the first one after every line, VSYNC after every frame, an idle one at the end."""
    seed = 0x2545F491
    for clock in range(LINE * LINES * FRAMES):
        seed = (seed * 1664525 + 1013904223) & 0xFFFFFFFF
        yield clock > 0 and clock % LINE == 0, clock > 0 and clock % (LINE * LINES) == 0, seed >> 24
    yield True, True, 0


def samples():
    """Eight samples a clock, D0 to D7 in bits 0 to 7, then PCLK, HSYNC, VSYNC: data moves with the falling edge."""
    for hsync, vsync, data in clocks():
        levels = data | hsync << 9 | vsync << 10
        yield from [levels] * 4 + [levels | 1 << 8] * 4
    yield levels


NAMES = [f"D{line}" for line in range(8)] + ["PCLK", "HSYNC", "VSYNC"]


def changes():
    """(sample, levels) wherever something changes."""
    before = None
    for number, levels in enumerate(samples()):
        if levels != before:
            yield number, levels
            before = levels


def sigrok(here):
    with tempfile.NamedTemporaryFile(suffix=".bin") as raw:
        raw.write(b"".join(levels.to_bytes(2, "little") for levels in samples()))
        raw.flush()
        subprocess.run(
            ["sigrok-cli", "-I", f"binary:numchannels=11:samplerate={RATE}", "-i", raw.name, "-o", f"{here}/sigrok.sr"],
            check=True,
        )


def csv(here):
    with open(f"{here}/digital.csv", "w") as out:
        out.write("Time [s]," + ",".join(NAMES) + "\n")
        for number, levels in changes():
            values = ",".join(str(levels >> bit & 1) for bit in range(len(NAMES)))
            out.write(f"{number / RATE:.9f},{values}\n")


def binary(here, version):
    folder = f"{here}/saleae-{version}"
    os.makedirs(folder, exist_ok=True)
    all_changes = list(changes())
    end = sum(1 for _ in samples()) / RATE
    for bit in range(len(NAMES)):
        level = first = all_changes[0][1] >> bit & 1
        times = []
        for number, levels in all_changes:
            if levels >> bit & 1 != level:
                level ^= 1
                times.append(number / RATE)
        # Version 1 may have gaps: the capture goes on in a second chunk at once.
        chunks = [(first, 0.0, end, times)] if version == 0 else []
        if version == 1:
            half = len(times) // 2
            middle = times[half] if times else end / 2
            chunks = [(first, 0.0, middle, times[:half]), ((first + half) % 2, middle, end, times[half:])]
        with open(f"{folder}/digital_{bit}.bin", "wb") as out:
            out.write(b"<SALEAE>" + struct.pack("<ii", version, 0))
            if version == 1:
                out.write(struct.pack("<Q", len(chunks)))
            for initial, begin, chunk_end, inside in chunks:
                out.write(struct.pack("<I", initial))
                if version == 1:
                    out.write(struct.pack("<d", RATE))
                out.write(struct.pack("<ddQ", begin, chunk_end, len(inside)))
                out.write(struct.pack(f"<{len(inside)}d", *inside))


def fst(here):
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/a.vcd", "w") as out:
            out.write("$timescale 1 ps $end\n$scope module tb $end\n")
            out.write("$var wire 1 p PCLK $end\n$var wire 1 h HSYNC $end\n$var wire 1 v VSYNC $end\n$var wire 8 d D [7:0] $end\n")
            out.write("$upscope $end\n$enddefinitions $end\n")
            before = ~0
            for number, levels in changes():
                out.write(f"#{round(number * 1e12 / RATE)}\n")
                for bit, name in (8, "p"), (9, "h"), (10, "v"):
                    if (levels ^ before) >> bit & 1:
                        out.write(f"{levels >> bit & 1}{name}\n")
                if (levels ^ before) & 255:
                    out.write(f"b{levels & 255:b} d\n")
                before = levels
        for packing, option in ("lz4", "-4"), ("fastlz", "-F"), ("zlib", "-Z"):
            subprocess.run(["vcd2fst", option, f"{folder}/a.vcd", f"{here}/gtkwave-{packing}.fst"], check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    sigrok(here)
    csv(here)
    binary(here, 0)
    binary(here, 1)
    fst(here)
