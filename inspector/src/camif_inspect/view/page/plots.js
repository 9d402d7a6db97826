// Rates over the last two minutes, and the histogram of a region.

import { on } from "./link.js";
import { make, scaled, counted } from "./page.js";
import { colour, look } from "./picture.js";
import { activePicture } from "./stage.js";

const PLOTS = [
  { key: "frames", title: "frames/s", text: (v) => v.toFixed(v < 10 ? 2 : 1), least: 1 },
  { key: "bytes", title: "on the line", text: (v) => scaled(v, "B/s"), least: 1000 },
  { key: "lost", title: "lost lines/s", text: (v) => rate(v), least: 1, bad: true },
  { key: "damaged", title: "CRC errors/s", text: (v) => rate(v), least: 1, bad: true },
];
const rate = (value) => (value && value < 10 ? value.toFixed(1) : String(Math.round(value)));

const history = [];
let most = 240, seconds = 0.5;
let hovered = null;

const drawn = PLOTS.map((plot) => {
  const value = make("b", { textContent: "–" }), canvas = make("canvas"), highest = make("div", { className: "top" });
  const element = make("div", { className: "plot" },
    make("div", { className: "now" }, value, make("span", { textContent: plot.title })), make("div", { className: "chart" }, canvas, highest));
  document.getElementById("plots").append(element);
  canvas.onpointermove = (event) => { hovered = 1 - event.offsetX / canvas.clientWidth; redraw(); };
  canvas.onpointerleave = () => { hovered = null; redraw(); };
  return { ...plot, value, canvas, highest };
});

on("welcome", (message) => { history.length = 0; most = message.history; seconds = message.sample_seconds; });
on("samples", ({ rates }) => {
  history.push(...rates);
  history.splice(0, Math.max(0, history.length - most));
  redraw();
});

function seriesOf(key, sample) {
  return key === "frames" ? Object.entries(sample.frames).map(([s, v]) => [Number(s), v]) : [[-1, sample[key]]];
}

function redraw() {
  // Half a minute at first, then all there is.
  const span = Math.min(most, Math.max(30 / seconds, history.length));
  const back = hovered === null ? 0 : Math.round(hovered * span);
  const shown = history[history.length - 1 - back];
  document.getElementById("line-note").textContent = back ? `${(back * seconds).toFixed(0)} s ago` : `last ${Math.round(span * seconds)} s`;
  for (const plot of drawn) {
    const { canvas, value, key } = plot;
    const ratio = devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    const context = canvas.getContext("2d"), w = canvas.width, h = canvas.height;
    // Rates are means over two seconds: frames that end just before or after a sample make no spikes.
    const valueOf = (i, s) => seriesOf(key, history[i]).find(([t]) => t === s)?.[1] ?? 0;
    const smooth = (i, s) => {
      if (plot.bad) return valueOf(i, s);
      const first = Math.max(0, i - Math.round(2 / seconds) + 1);
      let sum = 0;
      for (let j = first; j <= i; j++) sum += valueOf(j, s);
      return sum / (i - first + 1);
    };
    const names = [...new Set(history.flatMap((sample) => seriesOf(key, sample).map(([s]) => s)))];
    const lines = names.map((s) => [s, history.map((_, i) => smooth(i, s))]);
    const top = Math.max(plot.least, ...lines.flatMap(([, values]) => values)) * 1.1;
    const peak = Math.max(0, ...lines.flatMap(([, values]) => values));
    plot.highest.textContent = peak ? `max ${plot.text(peak)}` : "";
    context.fillStyle = colour("--rule");
    context.fillRect(0, h - 1, w, 1);
    for (const [s, values] of lines) {
      context.strokeStyle = plot.bad ? colour(peak ? "--bad" : "--good") : s >= 0 ? colour(`--stream-${s % 4}`) : colour("--gray");
      context.lineWidth = 1.5 * ratio;
      context.lineJoin = "round";
      context.beginPath();
      values.forEach((v, i) => context.lineTo(w - (values.length - 1 - i) * (w / span), h - 1.5 * ratio - (v / top) * (h - 12 * ratio)));
      context.stroke();
    }
    if (back) {
      context.fillStyle = colour("--soft");
      context.fillRect(w - back * (w / span), 0, 1, h);
    }
    const i = history.length - 1 - back;
    if (!shown) { value.textContent = "–"; continue; }
    const now = lines.map(([s]) => smooth(i, s));
    const text = key === "frames" ? (now.length ? now.map(plot.text).join(" · ") : "0") : plot.text(now[0] ?? 0);
    value.textContent = now.length > 2 && key === "frames" ? plot.text(Math.max(...now)) : text;
    value.classList.toggle("bad", Boolean(plot.bad && now[0] > 0));
  }
}

// Histogram

const canvas = document.getElementById("histogram"), table = document.getElementById("histogram-table");
const INK = { R: "--red", G: "--green", B: "--blue" };
const FALLBACK = ["--gray", "--blue", "--red"];
let done = "", last = 0;

/** Counts, mean, deviation and extremes of each channel of the region. */
export function histogram(picture, region) {
  const { width, height, channels, bits } = picture.head;
  const n = channels.length, shift = bits - 8;
  const x1 = Math.min(width, region.x + region.width), y1 = Math.min(height, region.y + region.height);
  const out = channels.map((name) => ({ name, bins: new Uint32Array(256), count: 0, sum: 0, squares: 0, least: Infinity, most: -Infinity }));
  for (let y = region.y; y < y1; y++) {
    if (!picture.present[y] && picture.head.closed) continue;
    for (let x = region.x, at = (y * width + region.x) * n; x < x1; x++) {
      for (let c = 0; c < n; c++, at++) {
        const value = picture.numbers[at], one = out[c];
        one.bins[value >> shift]++;
        one.count++;
        one.sum += value;
        one.squares += value * value;
        if (value < one.least) one.least = value;
        if (value > one.most) one.most = value;
      }
    }
  }
  return out;
}

function drawHistogram(now) {
  requestAnimationFrame(drawHistogram);
  const picture = activePicture();
  if (!picture?.head || now - last < 150) return;
  const { width, height, name } = picture.head;
  const wanted = JSON.stringify([picture.stream, picture.stamp, look.region, canvas.clientWidth, document.documentElement.dataset.theme]);
  if (wanted === done) return;
  done = wanted;
  last = now;
  const region = look.region && look.region.x < width && look.region.y < height ? look.region : { x: 0, y: 0, width, height };
  const channels = histogram(picture, region);
  const pixels = counted(channels[0].count);
  document.getElementById("histogram-of").textContent = look.region
    ? `${name} ${region.width} × ${region.height} at ${region.x}, ${region.y}` : `${name}, whole, ${pixels} pixels`;
  const ratio = devicePixelRatio || 1, w = (canvas.width = canvas.clientWidth * ratio), h = (canvas.height = canvas.clientHeight * ratio);
  const context = canvas.getContext("2d");
  // Black and white tower above all else in maps and clipped pictures: the scale is set by what lies between.
  const inner = Math.max(...channels.flatMap(({ bins }) => Array.from(bins.subarray(1, 255))));
  const top = Math.max(1, inner || Math.max(...channels.flatMap(({ bins }) => [bins[0], bins[255]])));
  context.globalCompositeOperation = document.documentElement.dataset.theme === "light" ? "multiply" : "lighter";
  channels.forEach(({ name: channel, bins }, c) => {
    context.fillStyle = colour(INK[channel] ?? (channels.length === 1 ? "--gray" : FALLBACK[c]));
    context.globalAlpha = channels.length === 1 ? 0.9 : 0.55;
    context.beginPath();
    context.moveTo(0, h);
    for (let i = 0; i < 256; i++) {
      const y = h - Math.min(1, bins[i] / top) * (h - 2);
      context.lineTo((i / 256) * w, y);
      context.lineTo(((i + 1) / 256) * w, y);
    }
    context.lineTo(w, h);
    context.fill();
  });
  const row = (cells, tag) => make("tr", {}, ...cells.map((text) => make(tag, { textContent: text })));
  const body = channels.map(({ name: channel, count, sum, squares, least, most: greatest }) => {
    const mean = sum / count, deviation = Math.sqrt(Math.max(0, squares / count - mean * mean));
    return row(count ? [channel, mean.toFixed(1), deviation.toFixed(1), least, greatest] : [channel, "–", "–", "–", "–"], "td");
  });
  table.replaceChildren(row(["", "mean", "deviation", "least", "greatest"], "th"), ...body);
}
requestAnimationFrame(drawHistogram);
