// The pictures side by side: zoom, pan, region and pointer, shared by all of them.

import { ask, on } from "./link.js";
import { Picture, STEPS, View, look } from "./picture.js";
import { button, make, toast } from "./page.js";

const views = document.getElementById("views");
const streams = new Map();
let dragPans = true;
let active = null;

export const pictures = () => [...streams.values()];
export const activePicture = () => (streams.get(active) ?? pictures()[0])?.picture ?? null;

function entryOf(stream) {
  if (streams.has(stream)) return streams.get(stream);
  const canvas = make("canvas", { tabIndex: 0 });
  canvas.setAttribute("role", "img");
  canvas.dataset.stream = stream;
  const swatch = make("i", { className: "swatch" });
  swatch.style.background = `var(--stream-${stream % 4})`;
  const name = make("b"), what = make("span", { className: "what" }), verdict = make("span", { className: "verdict" });
  const again = button("Ask again", async () => toast(await ask({ do: "resend", stream })));
  again.title = "ask the device for the missing lines again";
  again.hidden = true;
  const badge = make("div", { className: "badge", hidden: true });
  const bar = make("div", { className: "view-bar" }, swatch, name, what, verdict, again);
  const element = make("section", { className: "view" }, bar, make("div", { className: "well" }, canvas, badge));
  const picture = new Picture(stream);
  const entry = { picture, view: new View(picture, canvas), element, name, what, verdict, again, badge };
  streams.set(stream, entry);
  views.replaceChildren(...[...streams.keys()].sort((a, b) => a - b).map((key) => streams.get(key).element));
  watch(entry, canvas);
  return entry;
}

on("picture", (head) => {
  const entry = entryOf(head.stream);
  entry.picture.take(head);
  entry.name.textContent = head.name;
  entry.view.canvas.setAttribute("aria-label", `${head.name}; arrows move, plus and minus zoom`);
  entry.what.textContent = `#${head.sequence}  ${head.width} × ${head.height}  ${head.format}`;
  let text = head.verdict;
  if (head.missing && head.closed) text = `${head.good ? "" : `${text}, `}${head.missing} ${head.missing === 1 ? "line" : "lines"} missing`;
  else if (!head.closed) text = `${head.height - head.missing} of ${head.height} lines`;
  if (head.crc_ok === false) text += ", frame CRC wrong";
  entry.verdict.textContent = text;
  entry.verdict.title = text;
  entry.verdict.className = `verdict ${head.closed ? (head.whole ? "" : "bad") : "busy"}`;
  entry.again.hidden = !(head.missing && head.closed) || document.body.dataset.live !== "true";
  document.getElementById("nothing").hidden = true;
});

/** Marks a picture that is no longer new, and says since when. */
export function mark(stream, old, text) {
  const entry = streams.get(stream);
  if (!entry) return;
  entry.element.classList.toggle("old", old);
  entry.badge.hidden = !old;
  entry.badge.textContent = text;
}

// Zoom

const zoomText = document.getElementById("zoom");

function setScale(scale, view, event) {
  if (!view.picture.head) return;
  const keep = event ? view.pixelAt(event) : null;
  look.scale = scale;
  if (!scale) { look.x = look.y = 0.5; }
  if (keep && scale) {
    const [x, y] = view.pixelAt(event);
    look.x += (keep[0] - x) / view.picture.head.width;
    look.y += (keep[1] - y) / view.picture.head.height;
  }
}

function step(direction, view, event) {
  const now = view.place().scale / (devicePixelRatio || 1);
  const next = direction > 0 ? STEPS.find((s) => s > now * 1.001) : STEPS.findLast((s) => s < now * 0.999);
  if (next) setScale(next, view, event);
}

const anyView = () => (streams.get(active) ?? pictures()[0])?.view;
const withView = (act) => () => { const view = anyView(); if (view) act(view); };
export const zoomIn = withView((view) => step(1, view));
export const zoomOut = withView((view) => step(-1, view));
export const zoomFit = withView((view) => setScale(0, view));
export const zoomOne = withView((view) => setScale(1, view));
document.getElementById("zoom-in").onclick = zoomIn;
document.getElementById("zoom-out").onclick = zoomOut;
document.getElementById("zoom-fit").onclick = zoomFit;
document.getElementById("zoom-one").onclick = zoomOne;

function setDrag(pans) {
  dragPans = pans;
  document.getElementById("drag-pan").setAttribute("aria-pressed", pans);
  document.getElementById("drag-region").setAttribute("aria-pressed", !pans);
  views.classList.toggle("region", !pans);
}
document.getElementById("drag-pan").onclick = () => setDrag(true);
document.getElementById("drag-region").onclick = () => setDrag(false);

// Pointer

function watch(entry, canvas) {
  const { view, picture } = entry;
  let drag = null;
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    step(event.deltaY < 0 ? 1 : -1, view, event);
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    if (!picture.head || event.button > 1) return;
    canvas.setPointerCapture(event.pointerId);
    active = picture.stream;
    const region = event.button === 0 && dragPans === event.shiftKey;
    drag = { region, from: view.pixelAt(event), x: event.clientX, y: event.clientY, moved: false };
    canvas.classList.toggle("dragging", !region);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!picture.head) return;
    const { width, height } = picture.head;
    const [x, y] = view.pixelAt(event);
    look.pointer = x >= 0 && y >= 0 && x < width && y < height ? [Math.floor(x), Math.floor(y)] : null;
    if (!drag) return;
    drag.moved ||= Math.hypot(event.clientX - drag.x, event.clientY - drag.y) > 3;
    if (!drag.moved) return;
    if (drag.region) {
      const clamp = (value, most) => Math.max(0, Math.min(most, value));
      const left = Math.floor(clamp(Math.min(x, drag.from[0]), width - 1)), top = Math.floor(clamp(Math.min(y, drag.from[1]), height - 1));
      const right = Math.ceil(clamp(Math.max(x, drag.from[0]), width)), bottom = Math.ceil(clamp(Math.max(y, drag.from[1]), height));
      look.region = { x: left, y: top, width: Math.max(1, right - left), height: Math.max(1, bottom - top) };
    } else {
      if (!look.scale) look.scale = view.place().scale / (devicePixelRatio || 1);
      const now = view.pixelAt(event);
      look.x -= (now[0] - drag.from[0]) / width;
      look.y -= (now[1] - drag.from[1]) / height;
    }
  });
  const end = () => {
    if (drag && drag.region && !drag.moved) look.region = null;
    drag = null;
    canvas.classList.remove("dragging");
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("pointerleave", () => { look.pointer = null; });
  canvas.addEventListener("dblclick", () => setScale(0, view));
  canvas.addEventListener("focus", () => { active = picture.stream; });
  canvas.addEventListener("keydown", (event) => {
    const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
    if (event.ctrlKey || event.metaKey || event.altKey || !picture.head || (!x && !y)) return;
    event.preventDefault();
    // An eighth of what is seen; a picture that fits is held first, as a drag does.
    const { scale } = view.place();
    if (!look.scale) look.scale = scale / (devicePixelRatio || 1);
    look.x += (x * canvas.width) / 8 / scale / picture.head.width;
    look.y += (y * canvas.height) / 8 / scale / picture.head.height;
  });
}

const pointerText = document.getElementById("pointer");
let pointerDrawn = "";

function showPointer() {
  const wanted = JSON.stringify([look.pointer, look.region, look.scale, pictures().map(({ picture }) => picture.stamp)]);
  if (wanted === pointerDrawn) return;
  pointerDrawn = wanted;
  const view = anyView();
  if (view?.picture.head) {
    const scale = view.place().scale / (devicePixelRatio || 1);
    zoomText.textContent = look.scale ? `${scale >= 1 ? scale : `1/${1 / scale}`} ×` : `fit ${scale < 1 ? `${Math.round(scale * 100)}%` : `${scale} ×`}`;
  }
  if (!look.pointer) {
    pointerText.replaceChildren(make("u", {}, "Wheel zooms, drag pans, Shift-drag picks a region"));
    return;
  }
  const [x, y] = look.pointer;
  const parts = [make("span", {}, make("u", {}, "x"), `${x}`, make("u", {}, "y"), `${y}`)];
  for (const { picture, name } of pictures()) {
    const pixel = picture.at(x, y);
    if (!pixel) continue;
    const span = make("span", {}, make("u", {}, name.textContent));
    const sample = make("i");
    sample.style.background = `rgb(${Array.from(picture.context.getImageData(x, y, 1, 1).data.slice(0, 3)).join()})`;
    if (pixel.missing) span.append("missing");
    else {
      span.append(sample);
      picture.head.channels.forEach((channel, i) => span.append(make("u", {}, channel), String(pixel.values[i]).padStart(picture.head.bits > 8 ? 4 : 3)));
    }
    parts.push(span);
  }
  pointerText.replaceChildren(...parts);
}

function draw() {
  for (const { view } of pictures()) view.draw();
  showPointer();
  requestAnimationFrame(draw);
}
requestAnimationFrame(draw);
