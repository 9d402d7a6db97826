// The waveform: clock, sync and data at the pixel clocks that the report kept.
const digits = Math.ceil(page.bus.bits / 4);
const view = { perClock: 24, label: 66 };

for (const wave of page.waves) {
  wave.clocks = wave.samples.length / digits;
  wave.edges = [];
  let start = wave.start;
  for (const [clocks, sync] of wave.runs) {
    wave.edges.push({ start, sync });
    start += clocks;
  }
}

// What the wires are at a pixel clock; nothing where the report kept none.
function pinsAt(clock) {
  const wave = page.waves[lastUpTo(page.waves, clock, (wave) => wave.start)];
  if (!wave || clock >= wave.start + wave.clocks) return null;
  const place = (clock - wave.start) * digits;
  const { sync } = wave.edges[lastUpTo(wave.edges, clock, (edge) => edge.start)];
  return { data: parseInt(wave.samples.slice(place, place + digits), 16), hsync: sync & 1, vsync: sync >> 1 & 1 };
}

const hex = (data) => data.toString(16).toUpperCase().padStart(digits, "0");

function drawWaveform() {
  const bits = at("wires").checked ? page.bus.bits : 0;
  const { context, width, height } = prepared(at("waveform"), 176 + bits * 17);
  const { perClock, label } = view;
  const room = Math.max(width - label, 1);
  const middle = chosen.clock ?? page.waves[0]?.start ?? 0;
  view.first = Math.max(middle - room / perClock / 3, -1);
  const x = (clock) => label + (clock - view.first) * perClock;
  const from = Math.max(Math.floor(view.first), 0), to = Math.ceil(view.first + room / perClock);
  const pins = new Map();
  for (let clock = from - 1; clock <= to + 1; clock++) pins.set(clock, pinsAt(clock));
  context.save();
  context.beginPath();
  context.rect(label, 0, room, height);
  context.clip();

  // Time.
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500].find((step) => step * perClock >= 90) ?? 1000;
  context.fillStyle = ink("dim");
  for (let clock = Math.ceil(from / step) * step; clock <= to; clock += step) {
    line(context, ink("faint"), [[x(clock), 18], [x(clock), height]]);
    context.fillText(grouped(clock), x(clock) + 3, 8);
  }
  // What was not kept.
  for (let clock = from; clock <= to; clock++) {
    if (pins.get(clock)) continue;
    const start = clock;
    while (clock + 1 <= to && !pins.get(clock + 1)) clock++;
    context.fillStyle = ink("faint");
    context.fillRect(x(start), 22, (clock + 1 - start) * perClock, height - 26);
    if ((clock + 1 - start) * perClock > 130) {
      context.fillStyle = ink("dim");
      context.fillText("not kept in this report", Math.max(x(start), label) + 10, 44);
    }
  }
  // The pixel clock: the edge at which the bus is read is in the middle.
  const rising = page.bus.clock_edge === "rising";
  const levels = rising ? [52, 36] : [36, 52];
  for (let clock = from; clock <= to; clock++) {
    if (!pins.get(clock)) continue;
    const left = x(clock), half = left + perClock / 2, right = left + perClock;
    if (perClock < 5) {
      context.fillStyle = ink("pclk");
      context.globalAlpha = .35;
      context.fillRect(left, 36, perClock, 16);
      context.globalAlpha = 1;
    } else {
      const [before, after] = levels;
      line(context, ink("pclk"), [[left, after], [left, before], [half, before], [half, after], [right, after]]);
    }
  }
  trace("hsync", 62, 20, (pins) => pins.hsync);
  trace("vsync", 92, 20, (pins) => pins.vsync);
  bus(122, 26);
  for (let bit = 0; bit < bits; bit++) trace("data", 156 + (bits - 1 - bit) * 17, 12, (pins) => pins.data >> bit & 1);
  marks();
  context.restore();

  const name = (text, y, colour) => { context.fillStyle = ink(colour); context.fillText(text, 0, y); };
  name("PCLK", 44, "pclk");
  name("HSYNC", 72, "hsync");
  name("VSYNC", 102, "vsync");
  name(`D[${page.bus.bits - 1}:0]`, 135, "data");
  for (let bit = 0; bit < bits; bit++) name("D" + bit, 162 + (bits - 1 - bit) * 17, "dim");

  // The level of a wire over the clocks that are there.
  function trace(colour, top, high, level) {
    let points = [];
    const end = () => { if (points.length) line(context, ink(colour), points, 1.5); points = []; };
    for (let clock = from; clock <= to; clock++) {
      const here = pins.get(clock);
      if (!here) { end(); continue; }
      const y = level(here) ? top : top + high;
      points.push([x(clock), y], [x(clock + 1), y]);
    }
    end();
  }

  // The bus: a cell for each value that stands, with its value where there is room.
  function bus(top, high) {
    const middle = top + high / 2, text = context.measureText("0".repeat(digits)).width + 8;
    for (let clock = from; clock <= to; clock++) {
      const here = pins.get(clock);
      if (!here) continue;
      const start = clock;
      while (clock + 1 <= to && pins.get(clock + 1)?.data === here.data) clock++;
      const left = x(start), right = x(clock + 1), slope = Math.min(3, perClock / 4);
      line(context, ink("data"), [[left, middle], [left + slope, top], [right - slope, top], [right, middle],
        [right - slope, top + high], [left + slope, top + high], [left, middle]], 1.2);
      if (Math.min(right, width) - Math.max(left, label) >= text) {
        context.fillStyle = ink("ink");
        context.textAlign = "center";
        context.fillText(hex(here.data), (Math.max(left, label) + Math.min(right, width)) / 2, middle + .5);
        context.textAlign = "left";
      }
    }
  }

  // Where rows begin, where findings are, and the chosen clock.
  function marks() {
    const frame = page.frames[chosen.frame];
    (frame?.row_clocks ?? []).forEach((clock, row) => {
      if (clock === null || clock < from || clock > to) return;
      line(context, ink("accent"), [[x(clock), 18], [x(clock), height]]);
      context.fillStyle = ink("accent");
      context.fillText("row " + row, x(clock) + 4, 24);
    });
    page.places.forEach((place, index) => {
      if (place.clock < from || place.clock > to) return;
      context.fillStyle = ink("bad");
      context.globalAlpha = .14;
      context.fillRect(x(place.clock), 18, perClock, height);
      context.globalAlpha = 1;
      context.fillText(page.diagnosis.findings[index].fault, x(place.clock) + 4, height - 8);
      line(context, ink("bad"), [[x(place.clock), 18], [x(place.clock), height]], 1.5);
    });
  }
}

function clockAt(event) {
  return Math.floor(view.first + (event.clientX - at("waveform").getBoundingClientRect().left - view.label) / view.perClock);
}

function sayPins(clock) {
  const pins = clock >= 0 ? pinsAt(clock) : null, where = placeOf(clock);
  const row = where.row === null ? "" : ` · row ${where.row}`;
  at("wave-readout").textContent = pins
    ? `clock ${grouped(clock)} · ${seconds(clock)}${row} · HSYNC ${pins.hsync} VSYNC ${pins.vsync} · 0x${hex(pins.data)} = `
      + pins.data.toString(2).padStart(page.bus.bits, "0")
    : "\u00a0";
}

function zoom(factor) {
  view.perClock = Math.min(Math.max(view.perClock * factor, 1), 64);
  drawWaveform();
}
