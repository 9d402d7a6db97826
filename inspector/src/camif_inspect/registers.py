"""The register map of the camera interface block, with the names of its bits.

Offsets 0x00 to 0x28 are those of ST's digital camera interface (DCMI; RM0090 Rev 21 ch. 15, RM0433 ch. 29); from 0x40
on stand the block's own extensions. Names are the manual's.
"""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Field:
    """Bits of a register.

    Attributes:
        name: the manual's name.
        low: lowest bit.
        high: highest bit, itself included.
        meaning: what it does.
        values: names of values; a value without one is reserved where any has a name.
    """

    name: str
    low: int
    high: int
    meaning: str
    values: dict[int, str] = field(default_factory=dict)

    def of(self, value: int) -> int:
        """Take this field out of a register's value."""
        return (value >> self.low) & ((1 << (self.high - self.low + 1)) - 1)


@dataclass(frozen=True)
class Register:
    """A register of 32 bits.

    Attributes:
        name: the manual's name.
        offset: bytes from the base of the block.
        meaning: what it holds.
        fields: its bits, lowest first.
        writable: whether a write does anything.
        readable: whether a read only looks; reading DR takes a word out of the FIFO, so nobody reads it unasked.
    """

    name: str
    offset: int
    meaning: str
    fields: tuple[Field, ...] = ()
    writable: bool = True
    readable: bool = True

    def describe(self, value: int) -> str:
        """Name the fields that are not zero: `CAPTURE EDM=10 bits`."""
        words = []
        for part in self.fields:
            content = part.of(value)
            if content == 0:
                continue
            if part.high == part.low and not part.values:
                words.append(part.name)
            else:
                words.append(f"{part.name}={part.values.get(content, content)}")
        return " ".join(words)


def _bit(position: int, name: str, meaning: str, zero: str = "", one: str = "") -> Field:
    return Field(name, position, position, meaning, {0: zero, 1: one} if one else {})


_EVENTS = (
    _bit(0, "FRAME", "a frame, or the crop window, is complete"),
    _bit(1, "OVR", "a word came while the FIFO was full"),
    _bit(2, "ERR", "an embedded synchronisation code out of order"),
    _bit(3, "VSYNC", "a frame ended on the wires, captured or not"),
    _bit(4, "LINE", "a line ended on the wires, inside the crop window or not"),
)

_CODES = (
    Field("FSC", 0, 7, "frame start"),
    Field("LSC", 8, 15, "line start"),
    Field("LEC", 16, 23, "line end"),
    Field("FEC", 24, 31, "frame end"),
)

_DMA_FLAGS = (
    _bit(1, "HTIF", "half of a transfer is done"),
    _bit(2, "TCIF", "a transfer is done"),
    _bit(3, "TEIF", "the target lies outside lent memory"),
)

_ADDRESS = (
    Field("WORD", 0, 27, "first word in the slot"),
    Field("SLOT", 28, 30, "slot of lent memory"),
)

REGISTERS: tuple[Register, ...] = (
    Register(
        "CR",
        0x00,
        "control: what is captured, and how the pins are read",
        (
            _bit(0, "CAPTURE", "take frames from the next frame start on"),
            _bit(1, "CM", "capture mode", "continuous", "snapshot"),
            _bit(2, "CROP", "take the crop window only"),
            _bit(3, "JPEG", "HSYNC is data enable; the last word is padded with zeros"),
            _bit(4, "ESS", "synchronisation", "wires", "codes in the data"),
            _bit(5, "PCKPOL", "edge on which pins are sampled", "falling", "rising"),
            _bit(6, "HSPOL", "level of HSYNC at which data is not valid", "low", "high"),
            _bit(7, "VSPOL", "level of VSYNC at which data is not valid", "low", "high"),
            Field("FCRC", 8, 9, "frames taken", {0: "all", 1: "1/2", 2: "1/4"}),
            Field("EDM", 10, 11, "data wires", {0: "8 bits", 1: "10 bits", 2: "12 bits", 3: "14 bits"}),
            _bit(14, "ENABLE", "off holds the capture side in reset"),
            Field("BSM", 16, 17, "bytes of a line taken", {0: "all", 1: "1/2", 2: "1/4", 3: "2/4"}),
            _bit(18, "OEBS", "byte selection starts with", "first", "second"),
            _bit(19, "LSM", "lines taken", "all", "1/2"),
            _bit(20, "OELS", "line selection starts with", "first", "second"),
        ),
    ),
    Register(
        "SR",
        0x04,
        "status: the pins and the FIFO",
        (
            _bit(0, "HSYNC", "1 between lines"),
            _bit(1, "VSYNC", "1 between frames"),
            _bit(2, "FNE", "the FIFO holds a word"),
        ),
        writable=False,
    ),
    Register("RIS", 0x08, "events as they happened", _EVENTS, writable=False),
    Register("IER", 0x0C, "events that raise the interrupt", _EVENTS),
    Register("MIS", 0x10, "events that happened and are enabled", _EVENTS, writable=False),
    Register("ICR", 0x14, "events to clear, write 1; reads 0", _EVENTS),
    Register("ESCR", 0x18, "codes of embedded synchronisation", _CODES),
    Register("ESUR", 0x1C, "bits of the codes that are compared", _CODES),
    Register(
        "CWSTRT",
        0x20,
        "where the crop window starts",
        (Field("HOFFCNT", 0, 13, "pixel clocks before it"), Field("VST", 16, 28, "lines before it")),
    ),
    Register(
        "CWSIZE",
        0x24,
        "how large the crop window is",
        (Field("CAPCNT", 0, 13, "pixel clocks, less one"), Field("VLINE", 16, 29, "lines, less one")),
    ),
    Register("DR", 0x28, "data: takes a word out of the FIFO", (Field("DATA", 0, 31, "byte 0 first"),), False, False),
    Register(
        "XCR",
        0x40,
        "what DCMI does not have",
        (_bit(0, "MARKER", "sync wires", "gate the data", "mark ends of lines and frames"),),
    ),
    Register("LBCR", 0x44, "bytes of the line that ended last", (Field("BYTES", 0, 31, "bytes"),), writable=False),
    Register("FBCR", 0x48, "bytes of the frame that ended last", (Field("BYTES", 0, 31, "bytes"),), writable=False),
    Register("FLCR", 0x4C, "lines of the frame that ended last", (Field("LINES", 0, 31, "lines"),), writable=False),
    Register(
        "DCR",
        0x60,
        "the burst DMA's control",
        (
            _bit(0, "EN", "loads the count and starts at target 0"),
            _bit(1, "HTIE", "interrupt when half of a transfer is done"),
            _bit(2, "TCIE", "interrupt when a transfer is done"),
            _bit(3, "TEIE", "interrupt on an error"),
            _bit(4, "LBL", "a transfer is a line"),
            Field("MODE", 8, 9, "at the end of a transfer", {0: "single", 1: "circular", 2: "double"}),
            Field("BURST", 12, 13, "words a grant", {0: "1", 1: "2", 2: "4"}),
        ),
    ),
    Register(
        "DSR",
        0x64,
        "the burst DMA's flags",
        (
            *_DMA_FLAGS,
            _bit(8, "CT", "the target in use is 1"),
            Field("CW", 16, 31, "words of the line completed last"),
        ),
        writable=False,
    ),
    Register("DICR", 0x68, "flags to clear, write 1; reads 0", _DMA_FLAGS),
    Register("DNDTR", 0x6C, "words a transfer; read: words left", (Field("WORDS", 0, 31, "words"),)),
    Register("DM0AR", 0x70, "address of target 0", _ADDRESS),
    Register("DM1AR", 0x74, "address of target 1", _ADDRESS),
)

BY_NAME = {register.name: register for register in REGISTERS}
BY_OFFSET = {register.offset: register for register in REGISTERS}
