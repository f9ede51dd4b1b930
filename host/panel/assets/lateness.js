// How late this page is: while it is busy, what it receives waits, and so do its answers.

const WINDOW_MS = 60_000;
let windowBegan = 0;
let least = Infinity;
let leastBefore = Infinity;

/**
 * How much later a live frame is handled than the quickest one of the last minute, ms. The difference, as the
 * clocks of two computers differ.
 */
export function latenessOf(unixMs) {
  const now = performance.now();
  const delay = performance.timeOrigin + now - unixMs;
  if (now - windowBegan > WINDOW_MS) {
    windowBegan = now;
    leastBefore = least;
    least = Infinity;
  }
  least = Math.min(least, delay);
  return delay - Math.min(least, leastBefore);
}
