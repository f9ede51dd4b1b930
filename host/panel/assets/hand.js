// The hand of a person on a drawing of a leg: pointer, touch and arrow keys.

// By keys, °/s: as slow as a slow stretch, and fast enough for a catch.
const SLOW = 30;
const FAST = 200;
// At least so far with each press, °: a screen reader holds no key.
const NUDGE = 1;
// As the foot moves on the drawing.
const KEYS = { ArrowDown: 1, ArrowLeft: 1, ArrowUp: -1, ArrowRight: -1 };
// A page that was busy does not catch up what a key was held for.
const LONGEST_S = 0.1;
const SLIDER = ["role", "tabindex", "aria-valuemin", "aria-valuemax", "aria-valuenow", "aria-valuetext"];

/**
 * Lets a person move the leg that is drawn in `host`, a slider for screen readers. `angleAt(x, y)` is the angle of a
 * point on the screen, `angle()` that of the hand, or of the leg without one; `send(angle)` gets the angle that the
 * hand is moved to, once a picture at most. All are degrees. The returned `enable(range)` gets `{ least, most }`, or null
 * where nobody may move it; `announce(angle, text)` says where the leg is.
 */
export function makeHand(host, { angleAt, angle, send }) {
  const pressed = new Set();
  let range = null;
  let target = NaN;
  let sent = NaN;
  let waits = false;
  let grip = null;
  let fast = false;
  let isStepping = false;
  let steppedAt = null;

  function flush() {
    if (target === sent || !range) return;
    sent = target;
    send(target);
    waits = true;
    requestAnimationFrame(() => {
      waits = false;
      flush();
    });
  }

  // The first of a picture goes at once, the last one with the next picture.
  function aim(value) {
    if (!Number.isFinite(value)) return;
    target = Math.min(range.most, Math.max(range.least, value));
    if (!waits) flush();
  }

  /** Begins where the hand or the leg is: nothing jumps. */
  function take() {
    const from = angle();
    if (!range || !Number.isFinite(from)) return false;
    sent = NaN;
    aim(from);
    return true;
  }

  function press(event) {
    if (event.button !== 0 || grip || !take()) return;
    event.preventDefault();
    host.focus({ preventScroll: true });
    host.setPointerCapture(event.pointerId);
    grip = { id: event.pointerId, at: angleAt(event.clientX, event.clientY), from: target, turned: 0 };
  }

  // Round the knee it goes on counting: past straight up, the leg does not fly to the other end.
  function drag(event) {
    if (grip?.id !== event.pointerId) return;
    const at = angleAt(event.clientX, event.clientY);
    const step = at - grip.at;
    grip.turned += step - 360 * Math.round(step / 360);
    grip.at = at;
    aim(grip.from + grip.turned);
  }

  function drop(event) {
    if (grip?.id === event.pointerId) grip = null;
  }

  function step(now) {
    if (!pressed.size || !range) {
      isStepping = false;
      steppedAt = null;
      return;
    }
    requestAnimationFrame(step);
    const seconds = Math.min(LONGEST_S, Math.max(0, (now - (steppedAt ?? now)) / 1000));
    steppedAt = now;
    const sense = [...pressed].reduce((sum, key) => sum + KEYS[key], 0);
    aim(target + Math.sign(sense) * (fast ? FAST : SLOW) * seconds);
  }

  function keyDown(event) {
    fast = event.shiftKey;
    if (!(event.key in KEYS) || event.ctrlKey || event.metaKey || event.altKey || !range) return;
    event.preventDefault();
    if (pressed.has(event.key)) return;
    if (pressed.size === 0 && !take()) return;
    pressed.add(event.key);
    aim(target + KEYS[event.key] * NUDGE);
    if (isStepping) return;
    isStepping = true;
    requestAnimationFrame(step);
  }

  function keyUp(event) {
    fast = event.shiftKey;
    pressed.delete(event.key);
  }

  host.addEventListener("pointerdown", press);
  host.addEventListener("pointermove", drag);
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) host.addEventListener(kind, drop);
  host.addEventListener("keydown", keyDown);
  host.addEventListener("keyup", keyUp);
  // Without the focus the end of a key is not heard.
  host.addEventListener("blur", () => pressed.clear());

  return {
    enable(now) {
      if (Boolean(now) === Boolean(range)) return;
      range = now;
      grip = null;
      pressed.clear();
      host.classList.toggle("movable", Boolean(range));
      if (!range) {
        for (const name of SLIDER) host.removeAttribute(name);
        return;
      }
      host.setAttribute("role", "slider");
      host.tabIndex = 0;
      host.setAttribute("aria-valuemin", range.least);
      host.setAttribute("aria-valuemax", range.most);
    },
    announce(value, text) {
      if (!range) return;
      host.setAttribute("aria-valuenow", Math.round(value));
      host.setAttribute("aria-valuetext", text);
    },
  };
}
