// The one WebSocket to the server: token, requests and their replies, live
// frames. Everything else of the page listens here.

const KIND_TRACE = 2;
const listeners = new Map();
const waiting = new Map();
let socket = null;
let serial = 0;

/** The last message of each kind; a page that renders later finds it here. */
export const latest = {};

/** Calls this at each message of a kind, and at `open`, `lost`, `refused`, `frame`. */
export function on(kind, listener) {
  if (!listeners.has(kind)) listeners.set(kind, []);
  listeners.get(kind).push(listener);
}

function emit(kind, value) {
  for (const listener of listeners.get(kind) ?? []) listener(value);
}

/** The role of this page's link. */
export const isTeacher = () => latest.hello?.role === "teacher";
/** Whether this page controls the device. */
export const isController = () => latest.holder?.yours === true;
/** Whether a file is shown rather than a device. */
export const isReplay = () => latest.hello?.source.kind === "replay";

/** Sends a request; resolves with `ok` of its reply, rejects with an `Error` for people. */
export function ask(what, more = {}) {
  return new Promise((resolve, reject) => {
    if (socket?.readyState !== WebSocket.OPEN) return reject(new Error("not-connected"));
    const id = ++serial;
    waiting.set(id, { resolve, reject });
    socket.send(JSON.stringify({ id, do: what, ...more }));
  });
}

function settle(id, outcome, value) {
  const request = waiting.get(id);
  waiting.delete(id);
  request?.[outcome](value);
}

// Frames are answered here, not by a timer: hidden tabs throttle timers, and
// the server disarms when answers stay out.
function receiveFrame(data) {
  const view = new DataView(data);
  if (data.byteLength < 40 || view.getUint8(0) !== 1) return;
  const id = view.getUint32(4, true);
  if (view.getUint8(1) === KIND_TRACE) return settle(id, "resolve", view);
  socket.send(`{"seen":${id}}`);
  emit("frame", view);
}

function receiveText(message) {
  if ("re" in message) {
    if ("error" in message) settle(message.re, "reject", new Error(message.error));
    else settle(message.re, "resolve", message.ok);
    return;
  }
  for (const [kind, value] of Object.entries(message)) {
    latest[kind] = value;
    emit(kind, value);
  }
}

function open() {
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    socket.send(JSON.stringify({ token: sessionStorage.getItem("token") ?? "" }));
    emit("open");
  };
  socket.onmessage = ({ data }) =>
    typeof data === "string" ? receiveText(JSON.parse(data)) : receiveFrame(data);
  socket.onclose = () => {
    for (const id of [...waiting.keys()]) settle(id, "reject", new Error("not-connected"));
    if (latest.refused) return;
    latest.holder = { taken: false, yours: false };
    emit("holder", latest.holder);
    emit("lost");
    setTimeout(open, 1000);
  };
}

/** Takes the token from the address and connects. */
export function connect() {
  // The fragment reaches no server and no log; other ports cannot read this storage.
  if (location.hash.length > 1) {
    sessionStorage.setItem("token", location.hash.slice(1));
    history.replaceState(null, "", location.pathname);
  }
  open();
}
