// The websocket to the program: messages in, questions out, and a connection that comes back.

const listeners = new Map();
const questions = new Map();
let socket = null;
let next = 1;

export function on(type, handler) {
  if (!listeners.has(type)) listeners.set(type, []);
  listeners.get(type).push(handler);
}

function tell(type, message) {
  for (const handler of listeners.get(type) ?? []) handler(message);
}

/** Asks the program to do something; resolves to its answer, whose `ok` says whether it was done. */
export function ask(question) {
  if (!socket || socket.readyState !== WebSocket.OPEN) {
    return Promise.resolve({ ok: false, text: "the program is not there" });
  }
  return new Promise((resolve) => {
    const id = next++;
    questions.set(id, resolve);
    socket.send(JSON.stringify({ ...question, id }));
  });
}

const decoder = new TextDecoder();

function picture(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(decoder.decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  const take = (bytes) => { at += bytes; return new Uint8Array(buffer, at - bytes, bytes); };
  head.present = take(head.height);
  const pixels = head.rows * head.width;
  head.pixels = take(pixels * head.display);
  head.numbers = null;
  if (head.values) {
    at += at % 2;
    const count = pixels * head.channels.length;
    head.numbers = head.values === 2 ? new Uint16Array(buffer, at, count) : new Uint8Array(buffer, at, count);
  }
  tell("picture", head);
}

export function connect() {
  socket = new WebSocket(`ws://${location.host}/live`);
  socket.binaryType = "arraybuffer";
  socket.onmessage = ({ data }) => {
    if (typeof data !== "string") return picture(data);
    const message = JSON.parse(data);
    if (message.type === "answer") {
      questions.get(message.id)?.(message);
      questions.delete(message.id);
    } else {
      tell(message.type, message);
    }
  };
  socket.onclose = () => {
    for (const resolve of questions.values()) resolve({ ok: false, text: "the program has gone" });
    questions.clear();
    tell("gone", {});
    setTimeout(connect, 1000);
  };
}
