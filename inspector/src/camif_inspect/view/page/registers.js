// The register view: every register, and the bits of one by their names.

import { ask, on } from "./link.js";
import { button, hex, make, toast } from "./page.js";

const list = document.getElementById("register-list"), detail = document.getElementById("register-detail");
const note = document.getElementById("registers-note"), follow = document.getElementById("registers-follow");
let registers = [];
let chosen = 0;
let edited = null;
const values = new Map();
const changed = new Set();

on("welcome", (message) => {
  registers = message.registers;
  values.clear();
  rows();
  show();
});

function rows() {
  const body = registers.map((register, place) => {
    const value = values.get(register.offset);
    const row = make("tr", { title: register.meaning, onclick: () => choose(place) },
      make("td", { textContent: register.name }), make("td", { textContent: hex(register.offset, 2) }),
      make("td", { textContent: value === undefined ? "·" : hex(value) }));
    row.setAttribute("aria-selected", place === chosen);
    row.classList.toggle("changed", changed.has(register.offset));
    row.classList.toggle("unread", value === undefined);
    return row;
  });
  const top = list.scrollTop;
  list.replaceChildren(make("tbody", {}, ...body));
  list.scrollTop = top;
}

function choose(place) {
  chosen = Math.max(0, Math.min(registers.length - 1, place));
  edited = null;
  rows();
  show();
  list.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
}
list.onkeydown = (event) => {
  const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (move) { event.preventDefault(); choose(chosen + move); }
};

const fieldOf = (register, bit) => register.fields.find(({ low, high }) => bit >= low && bit <= high);
const contentOf = (field, value) => Math.floor(value / 2 ** field.low) % 2 ** (field.high - field.low + 1);

function show() {
  const register = registers[chosen];
  if (!register) return;
  const known = values.get(register.offset), value = edited ?? known;
  const live = document.body.dataset.live === "true";
  const entry = make("input", { value: value === undefined ? "" : `0x${hex(value)}`, placeholder: "0x…", disabled: !register.writable || !live, spellcheck: false });
  entry.setAttribute("aria-label", `value of ${register.name}`);
  entry.onchange = () => {
    const number = Number(entry.value.trim());
    if (!entry.value.trim() || !Number.isInteger(number) || number < 0 || number > 0xffffffff) {
      toast({ ok: false, text: `\`${entry.value}\` is no number of 32 bits; write 0x… or decimal` });
    } else edited = number;
    show();
  };
  entry.onkeydown = (event) => { if (event.key === "Enter") { entry.onchange(); write(); } };
  const send = button("Write", write);
  send.id = "register-write";
  send.disabled = !register.writable || !live || edited === null;
  const get = button("Read", () => read([register.offset]));
  get.disabled = !live;
  get.title = register.readable ? "" : register.meaning;
  const head = make("div", { className: "register-head" }, make("b", { textContent: register.name }),
    make("span", { textContent: register.meaning }), entry, get);
  if (register.writable) head.append(send);

  const bits = make("div", { className: "bits" });
  for (let bit = 31; bit >= 0; bit--) bits.append(make("i", { textContent: bit % 4 === 0 || bit === 31 ? bit : "" }));
  for (let bit = 31; bit >= 0; bit--) {
    const field = fieldOf(register, bit);
    const on = value === undefined ? "" : Math.floor(value / 2 ** bit) % 2;
    const cell = make("button", { textContent: value === undefined ? "·" : on, title: field ? `${bit}: ${field.name}, ${field.meaning}` : `${bit}: reserved` });
    cell.dataset.on = on;
    cell.dataset.bit = bit;
    cell.classList.toggle("reserved", !field);
    cell.classList.toggle("edited", edited !== null && known !== undefined && Math.floor(known / 2 ** bit) % 2 !== on);
    cell.disabled = !register.writable || value === undefined || !live;
    cell.onclick = () => { edited = on ? value - 2 ** bit : value + 2 ** bit; show(); };
    bits.append(cell);
  }
  const fields = register.fields.map((field) => {
    const content = value === undefined ? null : contentOf(field, value);
    const range = field.high === field.low ? `${field.low}` : `${field.high}:${field.low}`;
    const bits = field.high - field.low + 1;
    const named = Object.keys(field.values).length > 0;
    // A named value speaks for itself; a number needs its unit; a flag needs its meaning.
    const text = content === null || bits === 1 && !named ? field.meaning
      : named ? field.values[content] ?? "reserved" : bits === 8 ? `0x${hex(content, 2)} ${field.meaning}` : `${content} ${field.meaning}`;
    const row = make("div", { title: `${field.name}: ${field.meaning}` }, make("i", { textContent: range }), make("b", { textContent: field.name }), make("span", { textContent: text }));
    row.classList.toggle("zero", !content);
    return row;
  });
  // Whoever flips bits by the keyboard stays on the bit that was flipped.
  const flipped = detail.contains(document.activeElement) ? document.activeElement.dataset.bit : undefined;
  detail.replaceChildren(head, bits, make("div", { className: "fields" }, ...fields));
  if (flipped !== undefined) detail.querySelector(`[data-bit="${flipped}"]`)?.focus();
}

async function read(offsets) {
  const answer = await ask({ do: "read", offsets });
  if (!answer.ok) { toast(answer); return false; }
  changed.clear();
  for (const [offset, value] of Object.entries(answer.registers)) {
    const before = values.get(Number(offset));
    if (before !== undefined && before !== value) changed.add(Number(offset));
    values.set(Number(offset), value);
  }
  note.textContent = `${Object.keys(answer.registers).length} read`;
  rows();
  if (edited === null && !detail.contains(document.activeElement)) show();
  return true;
}

async function write() {
  const register = registers[chosen];
  if (edited === null || !register.writable) return;
  const answer = await ask({ do: "write", offset: register.offset, value: edited });
  toast(answer);
  if (answer.ok) {
    edited = null;
    document.activeElement?.blur();
    await read([register.offset]);
    show();
  }
}

const readable = () => registers.filter((register) => register.readable).map((register) => register.offset);
document.getElementById("registers-read").onclick = () => read(readable());
let following = false;
setInterval(async () => {
  // A slow device is asked again only when it has answered.
  if (!follow.checked || document.hidden || following) return;
  following = true;
  if (!(await read(readable()))) follow.checked = false;
  following = false;
}, 1000);
