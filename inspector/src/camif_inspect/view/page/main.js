// The page: what the program says goes to its parts, buttons go to the program.

import { ask, connect, on } from "./link.js";
import { look } from "./picture.js";
import { button, counted, make, toast } from "./page.js";
import { mark, pictures, zoomFit, zoomIn, zoomOne, zoomOut } from "./stage.js";
import "./plots.js";
import "./registers.js";

const at = (id) => document.getElementById(id);
let encodings = {};
let paused = false;
let gone = false;
let latest = null;

// Theme

const root = document.documentElement;
root.dataset.theme = localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
at("theme").onclick = () => {
  root.dataset.theme = root.dataset.theme === "light" ? "dark" : "light";
  localStorage.setItem("theme", root.dataset.theme);
};

// Buttons

const request = async (...words) => toast(await ask({ do: "ask", request: words }));
for (const element of document.querySelectorAll("[data-ask]")) element.onclick = () => request(element.dataset.ask);
at("snapshot").onclick = () => request("snapshot", at("snapshot-count").value);
at("save").onclick = async () => toast(await ask({ do: "save" }));
at("pause").onclick = async () => {
  const answer = await ask({ do: "pause", paused: !paused });
  if (!answer.ok) return toast(answer);
  paused = !paused;
  at("pause").setAttribute("aria-pressed", paused);
  at("pause").textContent = paused ? "Resume" : "Pause";
  if (latest) show(latest);
};
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input, select")) return;
  const act = { " ": () => at("pause").click(), s: () => at("save").click(), 0: zoomFit, 1: zoomOne, "+": zoomIn, "=": zoomIn, "-": zoomOut }[event.key];
  if (act && !(event.key === " " && event.target.matches("button"))) { event.preventDefault(); act(); }
});

// State

on("welcome", (message) => {
  gone = false;
  paused = false;
  at("pause").setAttribute("aria-pressed", false);
  at("pause").textContent = "Pause";
  at("source").textContent = message.source;
  at("source").title = message.source;
  at("log").replaceChildren();
  document.title = `${message.source} · camif inspect`;
  document.body.dataset.live = message.live;
  encodings = message.encodings;
  at("streams").replaceChildren();
  parametersFor = null;
  for (const element of document.querySelectorAll("#capture button, #capture input, #registers-read, #registers-follow, #ask input, #ask button")) {
    element.disabled = !message.live;
    if (!message.live) element.title = "a recording takes no commands";
  }
});
on("gone", () => {
  gone = true;
  at("link").dataset.state = "bad";
  at("link-state").textContent = "the program has ended";
  for (const { picture } of pictures()) mark(picture.stream, true, "old: the program has ended");
});

const seconds = (value) => (value < 90 ? `${value.toFixed(0)} s` : value < 5400 ? `${(value / 60).toFixed(0)} min` : `${(value / 3600).toFixed(1)} h`);

on("state", (state) => {
  latest = state;
  show(state);
  device(state);
  for (const stream of state.streams) controls(stream, state);
});

/** Says how the line is, and which pictures are old. */
function show(state) {
  const stopped = state.heartbeat?.state === "stopped";
  const youngest = Math.min(Infinity, ...state.streams.map(({ age }) => age));
  let how = "live", words = "live", why = "";
  const version = Object.keys(state.versions)[0];
  if (state.ended) [how, words, why] = ["old", "recording ended", "The recording is at its end."];
  else if (state.trouble) [how, words, why] = ["bad", "port gone, waiting", state.trouble];
  else if (version) [how, words, why] = ["bad", `protocol version ${version}`, `The device speaks version ${version} of the protocol, which this program does not.`];
  else if (state.noisy) [how, words, why] = ["bad", "noise", `Bytes come, and no packets: ${state.noise_hint}.`];
  else if (paused) [how, words] = ["old", "paused"];
  else if (stopped) [how, words, why] = ["old", "stopped", "The device is stopped. Press Start."];
  else if (!state.counts.bytes) [how, words, why] = ["waiting", "silent", "The port is open, and not a byte has come yet."];
  else if (youngest > 3) [how, words, why] = ["waiting", "no pictures", state.heartbeat?.cause && state.heartbeat.cause !== "none" ? `The camera's last time-out: ${state.heartbeat.cause}.` : "Packets come, and no picture yet."];
  at("link").dataset.state = how;
  at("link-state").textContent = words;
  at("nothing-why").textContent = why;
  at("device").textContent = state.device ?? "";
  at("device").title = state.device ?? "";
  for (const stream of state.streams) {
    const old = how === "bad" || state.ended || paused || stream.age > (stopped ? 0.8 : 2);
    const reason = paused ? "paused" : state.ended ? "recording ended" : how === "bad" ? words : stream.on === false ? "stream is off" : stopped ? "stopped" : "nothing new";
    mark(stream.stream, old, stream.age > 1.5 && !paused ? `old, ${seconds(stream.age)}: ${reason}` : `old: ${reason}`);
  }
}

const PAIRS = [
  ["delivered", "delivered"], ["dropped", "dropped"], ["lost", "damaged", true], ["skipped", "skipped"],
  ["overruns", "overruns", true], ["sync_errors", "sync errors", true], ["dma_errors", "DMA errors", true], ["lines_dropped", "lines dropped", true],
  ["packets_unsent", "not sent", true], ["packets_damaged", "bad commands", true],
];

function device({ heartbeat, counts }) {
  if (heartbeat) {
    const up = seconds(heartbeat.uptime / 1e6);
    at("device-state").textContent = `${heartbeat.state}, up ${up}${heartbeat.cause === "none" ? "" : `, last time-out: ${heartbeat.cause}`}`;
    at("device-state").title = at("device-state").textContent;
    at("heartbeat").replaceChildren(...PAIRS.flatMap(([key, name, bad]) => [
      make("dt", { textContent: name }), make("dd", { textContent: counted(heartbeat[key]), className: bad && heartbeat[key] ? "bad" : "" })]));
  }
  at("log-note").textContent = `${counted(counts.received)} packets, ${counted(counts.frames)} frames`;
}

// Streams

const rows = new Map();

function controls(stream, state) {
  const live = document.body.dataset.live === "true";
  const id = stream.stream;
  if (!rows.has(id) || !rows.get(id).element.isConnected) {
    const on = make("input", { type: "checkbox" }), name = make("span"), size = make("small");
    const choice = make("select");
    const stages = make("input", { className: "stages", spellcheck: false, placeholder: "pipeline, such as gray|gaussian:size=5,sigma=1.4" });
    stages.setAttribute("aria-label", "pipeline");
    choice.setAttribute("aria-label", "encoding");
    on.onchange = () => {
      const wanted = latest.streams.filter((other) => (other.stream === id ? on.checked : other.on)).map((other) => other.stream);
      request("streams", wanted.join() || "none");
    };
    choice.onchange = () => request("encoding", String(id), choice.value === "15" ? "auto" : encodings[choice.value]);
    stages.onchange = () => request("stages", String(id), stages.value.trim());
    const element = make("div", { className: "stream" }, make("label", {}, on, name), size, choice, stages);
    rows.set(id, { element, on, name, size, choice, stages });
    at("streams").append(element);
  }
  const row = rows.get(id);
  row.name.textContent = stream.name;
  row.size.textContent = stream.size?.join(" × ") ?? "";
  for (const input of [row.on, row.choice, row.stages]) input.disabled = !live;
  if (document.activeElement !== row.on) row.on.checked = stream.on ?? true;
  if (document.activeElement !== row.stages) row.stages.value = stream.pipeline;
  const offered = Object.keys(encodings).filter((code) => code === "15" || !state.encodings || (state.encodings >> code) & 1);
  if (row.choice.options.length !== offered.length) row.choice.replaceChildren(...offered.map((code) => make("option", { value: code, textContent: encodings[code] })));
  if (document.activeElement !== row.choice && stream.encoding !== null) row.choice.value = String(stream.encoding);
  if (live && state.device && parametersFor !== state.device) parameters(state.device);
}

// Parameters of the device, once for each device

let parametersFor = null;

async function parameters(name) {
  parametersFor = name;
  const answer = await ask({ do: "parameters" });
  if (!answer.ok) return;
  at("parameters").replaceChildren(...answer.parameters.map(({ number, value, least, greatest, name: text }) => {
    const input = make("input", { type: "number", value, min: least, max: greatest });
    input.setAttribute("aria-label", text);
    input.onchange = async () => {
      const told = await ask({ do: "set", parameter: number, value: Number(input.value) });
      toast(told);
      if (told.ok) value = told.parameter.value;
      input.value = value;
    };
    return make("label", { className: "parameter" }, make("span", { textContent: text }), make("small", { textContent: `${least} … ${greatest}` }), input);
  }));
}

// Log

/** Adds a line to the log, of so many seconds ago. */
function logged(level, text, age = 0) {
  const list = at("log"), time = new Date(Date.now() - 1000 * age).toTimeString().slice(0, 8);
  list.append(make("li", { className: level }, make("time", { textContent: time }), make("span", { textContent: text })));
  while (list.children.length > 1000) list.firstChild.remove();
}

on("log", ({ lines }) => {
  const list = at("log");
  const follows = list.scrollTop + list.clientHeight > list.scrollHeight - 30;
  for (const [level, text, age] of lines) logged(level, text, age);
  if (follows) list.scrollTop = list.scrollHeight;
});

/** Adds a line of this page's own to the log. */
function note(level, text) {
  logged(level, text);
  at("log").scrollTop = at("log").scrollHeight;
}

// Commands in words, with the ones before under the arrow keys

const said = [];
let place = 0;
at("ask").onsubmit = async (event) => {
  event.preventDefault();
  const words = at("ask-words").value.trim();
  if (!words) return;
  at("ask-words").value = "";
  said.push(words);
  place = said.length;
  note("asked", words);
  const answer = await ask({ do: "ask", request: split(words) });
  note(answer.ok ? "information" : "error", answer.text);
};
at("ask-words").onkeydown = (event) => {
  const move = { ArrowUp: -1, ArrowDown: 1 }[event.key];
  if (!move) return;
  event.preventDefault();
  place = Math.max(0, Math.min(said.length, place + move));
  at("ask-words").value = said[place] ?? "";
};

/** Words apart at spaces, but for those within quotes. */
const split = (text) => Array.from(text.matchAll(/"([^"]*)"|'([^']*)'|(\S+)/g), ([, double, single, plain]) => double ?? single ?? plain);

// The line between pictures and registers

const main = document.querySelector("main"), divider = at("divider");
const dock = (height) => { main.style.setProperty("--dock", height); };
if (localStorage.getItem("dock")) dock(localStorage.getItem("dock"));
divider.onpointerdown = (event) => { divider.setPointerCapture(event.pointerId); divider.classList.add("dragging"); };
divider.onpointermove = (event) => { if (divider.classList.contains("dragging")) dock(`${(100 * (innerHeight - event.clientY)) / innerHeight}vh`); };
divider.onpointerup = divider.onpointercancel = () => {
  divider.classList.remove("dragging");
  localStorage.setItem("dock", main.style.getPropertyValue("--dock"));
};
divider.onkeydown = (event) => {
  const up = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  if (!up) return;
  event.preventDefault();
  const share = Math.round((100 * at("dock").clientHeight) / innerHeight);
  dock(`${Math.max(10, Math.min(90, share + 4 * up))}vh`);
  localStorage.setItem("dock", main.style.getPropertyValue("--dock"));
};
divider.ondblclick = () => { main.style.removeProperty("--dock"); localStorage.removeItem("dock"); };

// For the console, and for tests.
window.inspector = { pictures, look, button };

connect();
