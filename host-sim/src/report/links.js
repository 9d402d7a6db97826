// Findings, picture, waveform and charts lead to one another.
function chooseRow(row) {
  const frame = page.frames[chosen.frame];
  if (!frame) return;
  row = Math.min(Math.max(row, 0), frame.row_clocks.length - 1);
  const clock = frame.row_clocks[row] ?? null;
  choose(clock === null ? { row, finding: null } : { row, clock, finding: null });
}

function chooseFinding(index) {
  const place = page.places[index];
  const shown = page.frames[place.frame]?.picture != null;
  choose({ finding: index, clock: place.clock, row: place.row, frame: shown ? place.frame : chosen.frame });
}

function chooseClock(clock) {
  const where = placeOf(clock);
  const finding = page.places.findIndex((place) => place.clock === clock);
  choose({ clock, finding: finding < 0 ? null : finding, row: where.row, frame: where.frame ?? chosen.frame });
}

const images = [...document.querySelectorAll("#picture img")];
const image = () => images[shownFrames.findIndex(({ index }) => index === chosen.frame)];

function drawPicture() {
  images.forEach((each) => { each.hidden = each !== image(); });
  document.querySelectorAll("#tabs button").forEach((button, index) => {
    button.setAttribute("aria-selected", shownFrames[index].index === chosen.frame);
  });
  document.querySelectorAll(".finding").forEach((button, index) => button.setAttribute("aria-pressed", index === chosen.finding));
  document.querySelectorAll(".flag").forEach((flag) => flag.remove());
  const mark = at("row-mark"), height = page.bus.height, place = page.places[chosen.finding];
  const everywhere = place?.everywhere ?? false;
  mark.hidden = !image() || (chosen.row === null && !everywhere);
  mark.classList.toggle("everywhere", everywhere);
  if (everywhere) mark.style.cssText = "top: 0; height: 100%";
  else mark.style.cssText = `top: ${100 * chosen.row / height}%; height: ${100 / height}%`;
  page.places.forEach((place, index) => {
    if (place.frame !== chosen.frame || place.row === null) return;
    const flag = document.createElement("button");
    flag.className = "flag";
    flag.type = "button";
    flag.textContent = index + 1;
    flag.title = page.diagnosis.findings[index].fault;
    flag.style.top = `${100 * (place.row + .5) / height}%`;
    flag.addEventListener("click", (event) => { event.stopPropagation(); chooseFinding(index); });
    at("picture").append(flag);
  });
  const frame = page.frames[chosen.frame];
  if (!frame) return;
  const clock = chosen.row === null ? null : frame.row_clocks[chosen.row];
  at("row-readout").textContent = everywhere ? `frame ${frame.sequence}: all of it`
    : chosen.row === null ? `frame ${frame.sequence}: ${frame.verdict}`
    : `frame ${frame.sequence}, row ${chosen.row}` + (clock == null ? ": did not come" : ` begins at clock ${grouped(clock)}, ${seconds(clock)}`);
}

function draw() {
  drawPicture();
  drawWaveform();
  drawLines();
  drawActivity();
  sayPins(chosen.clock ?? -1);
}
listeners.push(draw);

at("picture").addEventListener("click", (event) => {
  const shown = image();
  if (!shown) return;
  const box = shown.getBoundingClientRect();
  chooseRow(Math.floor((event.clientY - box.top) / box.height * page.bus.height));
});
at("picture").addEventListener("keydown", (event) => {
  const step = { ArrowUp: -1, ArrowDown: 1, PageUp: -16, PageDown: 16 }[event.key];
  if (!step) return;
  event.preventDefault();
  chooseRow((chosen.row ?? -1) + step);
});
document.querySelectorAll(".finding").forEach((button, index) => button.addEventListener("click", () => chooseFinding(index)));
document.querySelectorAll("#tabs button").forEach((button, index) => button.addEventListener("click", () => {
  const { frame, index: which } = shownFrames[index];
  choose({ frame: which, row: null, finding: null, clock: frame.row_clocks.find((clock) => clock !== null) ?? chosen.clock });
}));
at("row-before").addEventListener("click", () => chooseRow((chosen.row ?? 1) - 1));
at("row-after").addEventListener("click", () => chooseRow((chosen.row ?? -1) + 1));
at("line-end").addEventListener("click", () => {
  const shown = linesShown();
  if (!shown || chosen.clock === null) return;
  const { start, samples } = shown.cut, index = Math.max(lastUpTo(start, chosen.clock), 0);
  const end = start[index] + samples[index] - 1;
  choose({ clock: chosen.clock === end ? start[index] : end });
});
at("in").addEventListener("click", () => zoom(1.5));
at("out").addEventListener("click", () => zoom(1 / 1.5));
at("wires").addEventListener("change", drawWaveform);

// The waveform is dragged, or clicked.
let drag = null;
at("waveform").addEventListener("pointerdown", (event) => {
  drag = { x: event.clientX, clock: chosen.clock ?? 0, moved: false };
  at("waveform").setPointerCapture(event.pointerId);
});
at("waveform").addEventListener("pointermove", (event) => {
  if (!drag) return sayPins(clockAt(event));
  const clocks = (drag.x - event.clientX) / view.perClock;
  drag.moved ||= Math.abs(event.clientX - drag.x) > 4;
  if (drag.moved) {
    chosen.clock = Math.max(Math.round(drag.clock + clocks), 0);
    drawWaveform();
  }
});
at("waveform").addEventListener("pointerup", (event) => {
  const clicked = drag && !drag.moved;
  drag = null;
  chooseClock(Math.max(clicked ? clockAt(event) : chosen.clock, 0));
});
at("waveform").addEventListener("wheel", (event) => {
  if (event.ctrlKey) { event.preventDefault(); zoom(event.deltaY < 0 ? 1.25 : .8); }
}, { passive: false });
at("waveform").addEventListener("keydown", (event) => {
  const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -16, PageDown: 16 }[event.key];
  if (step) { event.preventDefault(); chooseClock(Math.max((chosen.clock ?? 0) + step, 0)); }
  if (event.key === "+" || event.key === "=") zoom(1.5);
  if (event.key === "-") zoom(1 / 1.5);
});
at("lines").addEventListener("click", (event) => {
  const shown = linesShown(), box = at("lines").getBoundingClientRect();
  if (!shown) return;
  const share = (event.clientX - box.left - margin.left) / (box.width - margin.left - margin.right);
  const count = shown.cut.start.length;
  chooseClock(shown.cut.start[Math.min(Math.max(Math.floor(share * count), 0), count - 1)]);
});
at("activity").addEventListener("click", (event) => {
  const { clocks } = activityTimes(), box = at("activity").getBoundingClientRect();
  const share = (event.clientX - box.left - margin.left) / (box.width - margin.left - margin.right);
  chooseClock(Math.floor(Math.min(Math.max(share, 0), 1) * clocks));
});
at("raw").addEventListener("toggle", () => {
  if (at("raw").open) at("json").textContent = JSON.stringify(page, (key, value) => (key === "edges" ? undefined : value), 1);
});
window.addEventListener("resize", draw);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);

choose({ frame: shownFrames[0]?.index ?? null });
if (page.places.length) chooseFinding(0);
else if (shownFrames.length) choose({ clock: shownFrames[0].frame.row_clocks.find((clock) => clock !== null) ?? 0 });
else draw();
