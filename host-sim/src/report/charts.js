// Clocks a line, and FIFO and DMA over time.
const margin = { left: 48, right: 10, top: 12, bottom: 22 };
const fault = (value, expected) => expected > 0 && value !== expected;

function axis(context, width, height, low, high, y, text) {
  context.fillStyle = ink("dim");
  context.textAlign = "right";
  for (const value of new Set([low, high])) {
    line(context, ink("faint"), [[margin.left, y(value)], [width - margin.right, y(value)]]);
    context.fillText(text(value), margin.left - 6, y(value));
  }
  context.textAlign = "left";
}

// Samples and period of each line of the chosen frame.
function linesShown() {
  const frame = page.frames[chosen.frame], cut = page.cuts[frame?.cut ?? 0];
  if (!cut) return null;
  const periods = cut.start.slice(1).map((start, index) => start - cut.start[index]);
  return { cut, periods };
}

function drawLines() {
  const { context, width, height } = prepared(at("lines"), 190);
  const shown = linesShown();
  if (!shown || !shown.cut.samples.length) return;
  const { cut, periods } = shown, expected = page.bus.samples_per_line, count = cut.samples.length;
  const x = (index) => margin.left + (index + .5) / count * (width - margin.left - margin.right);
  const half = (height - margin.top - margin.bottom - 16) / 2;
  const band = (values, usual, top, colour) => {
    const low = values.reduce((a, b) => Math.min(a, b), usual), high = values.reduce((a, b) => Math.max(a, b), usual);
    const pad = Math.max((high - low) * .1, 1);
    const y = (value) => top + half - (value - low + pad) / (high - low + 2 * pad) * half;
    axis(context, width, height, low, high, y, grouped);
    context.setLineDash([3, 3]);
    line(context, ink("pclk"), [[margin.left, y(usual)], [width - margin.right, y(usual)]]);
    context.setLineDash([]);
    line(context, ink(colour), values.map((value, index) => [x(index), y(value)]), 1.4);
    return y;
  };
  const y = band(cut.samples, expected, margin.top, "data");
  band(periods, page.bus.clocks_per_line, margin.top + half + 16, "hsync");
  cut.samples.forEach((samples, index) => {
    if (!fault(samples, expected)) return;
    context.fillStyle = ink("bad");
    context.beginPath();
    context.arc(x(index), y(samples), 3, 0, 7);
    context.fill();
  });
  context.fillStyle = ink("dim");
  context.fillText("line 0", margin.left, height - 9);
  context.textAlign = "right";
  context.fillText("line " + (count - 1), width - margin.right, height - 9);
  context.textAlign = "left";
  const line_ = lastUpTo(cut.start, chosen.clock ?? -1);
  if (line_ >= 0 && line_ < count) line(context, ink("accent"), [[x(line_), margin.top], [x(line_), height - margin.bottom]]);
  const other = cut.samples.filter((samples) => fault(samples, expected)).length;
  at("lines-readout").innerHTML = "";
  at("lines-readout").append(legend("data", "clocks with data"), legend("hsync", "clocks from start to start"),
    `${other ? grouped(other) : "none"} of ${grouped(count)} lines differ from the profile's ${grouped(expected)}`);
}

function legend(colour, text) {
  const mark = document.createElement("span");
  mark.style.cssText = `color: var(--${colour}); margin-right: 14px`;
  mark.textContent = "— " + text;
  return mark;
}

function activityTimes() {
  const times = [];
  let clock = 0;
  for (const bucket of page.activity?.buckets ?? []) {
    times.push(clock);
    clock += bucket.clocks;
  }
  return { times, clocks: clock };
}

function drawActivity() {
  const { context, width, height } = prepared(at("activity"), 190);
  const { times, clocks } = activityTimes();
  if (!clocks) return;
  const buckets = page.activity.buckets, room = width - margin.left - margin.right;
  const x = (clock) => margin.left + clock / clocks * room;
  const halves = (height - margin.bottom - margin.top - 20) / 2, words = page.fifo_words;
  const level = (value) => margin.top + halves - value / words * halves;
  // Columns of about two pixels: a mean of so many buckets each.
  const columns = [], wide = Math.max(Math.ceil(buckets.length / (room / 2)), 1);
  for (let index = 0; index < buckets.length; index += wide) {
    const part = buckets.slice(index, index + wide), sum = (key) => part.reduce((sum, bucket) => sum + bucket[key], 0);
    columns.push({
      start: times[index], clocks: sum("clocks"), overruns: sum("overruns"), rate: 1000 * sum("requests") / Math.max(sum("clocks"), 1),
      least: Math.min(...part.map((bucket) => bucket.least)), most: Math.max(...part.map((bucket) => bucket.most)),
    });
  }
  const most = columns.reduce((most, column) => Math.max(most, column.rate), 1);
  const rate = (value) => height - margin.bottom - value / most * halves;
  axis(context, width, height, 0, words, level, (value) => value + " w");
  axis(context, width, height, 0, most, rate, (value) => Math.round(value) + "");
  for (const column of columns) {
    const left = x(column.start), across = Math.max(x(column.start + column.clocks) - left, .6), base = height - margin.bottom;
    context.globalAlpha = .8;
    context.fillStyle = ink(column.overruns ? "bad" : "data");
    context.fillRect(left, level(column.most), across, Math.max(level(column.least) - level(column.most), 1.2));
    context.fillStyle = ink("vsync");
    context.fillRect(left, rate(column.rate), across, base - rate(column.rate));
    context.globalAlpha = 1;
    if (column.overruns) line(context, ink("bad"), [[left, margin.top - 6], [left, base]]);
  }
  for (const cut of page.cuts) {
    if (cut.start.length && cut.start[0] < clocks) {
      line(context, ink("rule"), [[x(cut.start[0]), margin.top - 6], [x(cut.start[0]), height - margin.bottom]]);
    }
  }
  for (const place of page.places) {
    if (place.clock <= clocks) {
      context.fillStyle = ink("bad");
      context.fillRect(x(place.clock) - 1, height - margin.bottom + 2, 3, 6);
    }
  }
  if (chosen.clock !== null && chosen.clock <= clocks) {
    line(context, ink("accent"), [[x(chosen.clock), margin.top], [x(chosen.clock), height - margin.bottom]]);
  }
  context.fillStyle = ink("dim");
  context.fillText("0", margin.left, height - 9);
  context.textAlign = "right";
  context.fillText(grouped(clocks) + " clocks", width - margin.right, height - 9);
  context.textAlign = "left";
  const overruns = buckets.reduce((sum, bucket) => sum + bucket.overruns, 0);
  at("activity-readout").innerHTML = "";
  at("activity-readout").append(legend("data", `words in the FIFO, least to most (of ${words})`),
    legend("vsync", "DMA bursts in 1,000 clocks"), overruns ? `${overruns} overruns` : "no overrun");
}
