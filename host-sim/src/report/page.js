// The numbers, what is chosen, and what all parts of the page need.
const page = JSON.parse(document.getElementById("numbers").textContent);
const at = (id) => document.getElementById(id);
const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const grouped = (number) => number.toLocaleString("en-US");

// What is chosen: a frame that has a picture, a row of it, a finding, and the pixel clock in the middle of the waveform.
const chosen = { frame: null, row: null, finding: null, clock: null };
const listeners = [];

function choose(change) {
  Object.assign(chosen, change);
  for (const listener of listeners) listener(change);
}

const shownFrames = page.frames.map((frame, index) => ({ frame, index })).filter(({ frame }) => frame.picture !== null);

// The last place in an ascending list whose value is not above another; -1 if all are.
function lastUpTo(list, value, key = (item) => item) {
  let low = 0, high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (key(list[middle]) <= value) low = middle + 1; else high = middle;
  }
  return low - 1;
}

// The frame and row in which a pixel clock shows; nulls if it is in no picture of the page.
function placeOf(clock) {
  for (const { frame, index } of shownFrames) {
    const clocks = frame.row_clocks.filter((start) => start !== null), cut = page.cuts[frame.cut];
    if (!cut || !clocks.length) continue;
    const end = cut.start[cut.start.length - 1] + cut.samples[cut.samples.length - 1];
    if (clock >= clocks[0] && clock < end) return { frame: index, row: Math.max(lastUpTo(clocks, clock), 0) };
  }
  return { frame: null, row: null };
}

function seconds(clocks) {
  const time = clocks / (page.diagnosis.measured.pclk_hz || page.bus.pclk_hz);
  return time < 1e-3 ? (time * 1e6).toFixed(2) + " µs" : (time * 1e3).toFixed(3) + " ms";
}

// A canvas as sharp as the screen, cleared; sizes are in CSS pixels.
function prepared(canvas, height) {
  const scale = window.devicePixelRatio || 1, width = canvas.clientWidth;
  canvas.style.height = height + "px";
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  const context = canvas.getContext("2d");
  context.scale(scale, scale);
  context.font = "11px " + ink("mono");
  context.textBaseline = "middle";
  return { context, width, height };
}

function line(context, colour, points, width = 1) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  points.forEach(([x, y], index) => (index ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
}
