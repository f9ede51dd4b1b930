// The one WebSocket to the server: token, requests and their replies, live
// frames. Everything else of the page listens here.

import { HEADER } from "./bins.js";
import { storedToken, storeToken } from "./storage.js";

const VERSION = 2;
const KIND_TRACE = 2;
const KIND_SAMPLES = 3;
// The server sends something every 100 ms. Without a message for so long the page no longer
// knows what the device does.
const SILENT_AFTER_MS = 400;
// A connection that hangs may never end by itself: after so long a new one is tried.
const ABANDON_AFTER_MS = 4000;
const LOOK_EVERY_MS = 50;
// These links have a page of their own; the key stays with the tab.
const PAGES = { student: "/student.html", remote: "/remote.html" };
const listeners = new Map();
const waiting = new Map();
let socket = null;
let serial = 0;
let newest;
let heardAt = 0;
let lookedAt = 0;
let isSilent = false;

/** The last message of each kind; a page that renders later finds it here. */
export const latest = {};

/**
 * Calls this at each message of a kind, and at `open`, `lost`, `refused`, `frame`, `samples`; at `silent`, with the
 * seconds, while nothing arrives; at `heard` when something does again.
 */
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
    // The newest frame says how old this request is when it arrives.
    socket.send(JSON.stringify({ id, do: what, newest, ...more }));
  });
}

/** Sends what has no reply, if there is a connection. */
export function tell(message) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
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
  if (data.byteLength < HEADER || view.getUint8(0) !== VERSION) return;
  const id = view.getUint32(4, true);
  if (view.getUint8(1) === KIND_TRACE) return settle(id, "resolve", view);
  if (view.getUint8(1) === KIND_SAMPLES) return emit("samples", view);
  socket.send(`{"seen":${id}}`);
  newest = id;
  emit("frame", view);
}

/** Goes to the page of this link; returns whether it is another one. */
function leavesFor(role) {
  const isOther = Object.values(PAGES).includes(location.pathname);
  const page = PAGES[role] ?? (isOther ? "/" : location.pathname);
  if (page === location.pathname) return false;
  location.replace(page + location.hash);
  return true;
}

function receiveText(message) {
  if (message.hello && leavesFor(message.hello.role)) return;
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

function heard() {
  heardAt = performance.now();
  if (!isSilent) return;
  isSilent = false;
  emit("heard");
}

// While this page itself was busy, messages wait behind this timer: they have their turn first.
function lookForSilence() {
  const now = performance.now();
  const wasBusy = now - lookedAt > 4 * LOOK_EVERY_MS;
  lookedAt = now;
  if (wasBusy || !socket || latest.refused) return;
  const silent = now - heardAt;
  if (silent >= ABANDON_AFTER_MS) return abandon();
  if (socket.readyState !== WebSocket.OPEN || silent < SILENT_AFTER_MS) return;
  isSilent = true;
  emit("silent", silent / 1000);
}

// What was sent may still arrive: the server does not carry out what is too old, but a stop.
function abandon() {
  socket.onopen = socket.onmessage = socket.onclose = null;
  socket.close();
  lose();
}

function lose() {
  socket = null;
  isSilent = false;
  for (const id of [...waiting.keys()]) settle(id, "reject", new Error("not-connected"));
  if (latest.refused) return;
  latest.holder = { taken: false, yours: false };
  emit("holder", latest.holder);
  emit("lost");
  setTimeout(open, 1000);
}

function open() {
  newest = undefined;
  heardAt = performance.now();
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    socket.send(JSON.stringify({ token: storedToken() }));
    heardAt = performance.now();
    emit("open");
  };
  socket.onmessage = ({ data }) => {
    heard();
    if (typeof data === "string") receiveText(JSON.parse(data));
    else receiveFrame(data);
  };
  socket.onclose = lose;
}

/** What is wrong with the key of a link that was refused: `none`, `cut` or `old`. */
export function keyFault() {
  const token = storedToken();
  if (token === "") return "none";
  return /^[0-9a-f]{32}$/.test(token) ? "old" : "cut";
}

/** Takes the token from the address and connects. */
export function connect() {
  // The fragment reaches no server and no log; other ports cannot read this storage.
  if (location.hash.length > 1) {
    // Where nothing can be stored, the address keeps it for a reload.
    const isStored = storeToken(location.hash.slice(1));
    if (isStored) history.replaceState(null, "", location.pathname + location.search);
  }
  open();
  setInterval(lookForSilence, LOOK_EVERY_MS);
}
