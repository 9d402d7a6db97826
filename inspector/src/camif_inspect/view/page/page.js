// Small things that every part of the page uses.

/** Makes an element with properties and children. */
export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

export function button(text, act) {
  return make("button", { textContent: text, onclick: act });
}

const box = document.getElementById("toast");
let timer = 0;

/** Shows the text of an answer for a moment; one that was refused longer. */
export function toast(answer) {
  if (!answer.text) return;
  box.textContent = answer.text;
  box.className = answer.ok ? "shown" : "shown bad";
  clearTimeout(timer);
  timer = setTimeout(() => { box.className = answer.ok ? "" : "bad"; }, answer.ok ? 2500 : 6000);
}

export const counted = (value) => value.toLocaleString("en-US").replaceAll(",", "\u202f");

/** A number with a prefix: 1.23 M. */
export function scaled(value, unit) {
  for (const [size, prefix] of [[1e9, "G"], [1e6, "M"], [1e3, "k"]]) {
    if (value >= size) return `${(value / size).toPrecision(3)} ${prefix}${unit}`;
  }
  return `${Math.round(value)} ${unit}`;
}

export const hex = (value, digits = 8) => value.toString(16).toUpperCase().padStart(digits, "0");
