// What the program has put into the page: texts, presets, the knee as WebAssembly.

import { byId } from "../dom.js";

/** All of it, as `host/panel/src/page/data.rs` writes it. */
export const data = JSON.parse(byId("data").textContent);

/** The bytes of a file that is written in base64. */
export const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
