// Drawing on a canvas: envelopes of bins, shades, marks. Knows pixels and
// columns, nothing of the page.

const TILE = 8;

/** The colours of the style sheet's variables, read again when the theme changes. */
export class Colours {
  constructor() {
    this.cache = new Map();
    this.patterns = new Map();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.cache.clear();
      this.patterns.clear();
    });
  }

  get(name) {
    if (!this.cache.has(name)) {
      this.cache.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
    }
    return this.cache.get(name);
  }

  /** A fill for a shade: a tint of its colour, with hatches. */
  shade(ctx, name, pattern) {
    const key = `${name} ${pattern}`;
    if (!this.patterns.has(key))
      this.patterns.set(key, ctx.createPattern(this.tile(name, pattern), "repeat"));
    return this.patterns.get(key);
  }

  /** The picture of a shade; the legend shows it, too. */
  tile(name, pattern) {
    const scale = Math.max(1, Math.round(devicePixelRatio));
    const size = TILE * scale;
    const tile = Object.assign(document.createElement("canvas"), { width: size, height: size });
    const ctx = tile.getContext("2d");
    ctx.fillStyle = ctx.strokeStyle = this.get(name);
    ctx.globalAlpha = pattern === "solid" ? 0.4 : 0.22;
    ctx.fillRect(0, 0, size, size);
    ctx.globalAlpha = 0.75;
    ctx.lineWidth = 1.5 * scale;
    const line = (...points) => {
      ctx.beginPath();
      ctx.moveTo(points[0], points[1]);
      ctx.lineTo(points[2], points[3]);
      ctx.stroke();
    };
    for (const shift of [-size, 0, size]) {
      if (pattern === "rising" || pattern === "crossed") line(shift, size, shift + size, 0);
      if (pattern === "falling" || pattern === "crossed") line(shift, 0, shift + size, size);
    }
    if (pattern === "upright") line(size / 2, 0, size / 2, size);
    return tile;
  }
}

// One polygon for each piece without a gap: along the highest values, and
// back along the lowest ones, with one corner a pixel at most.
function outline(xs, highs, lows) {
  const path = new Path2D();
  path.moveTo(xs[0], highs[0]);
  for (let i = 1; i < xs.length; i++) path.lineTo(xs[i], highs[i]);
  for (let i = xs.length - 1; i >= 0; i--) path.lineTo(xs[i], lows[i]);
  path.closePath();
  return path;
}

/**
 * Draws the band between two columns. `map` has `x(time)`, `y(value)` in pixels.
 * `look`: colour, fill (its opacity), width, dash.
 */
export function paintEnvelope(ctx, map, times, low, high, from, to, look) {
  let xs = [];
  let highs = [];
  let lows = [];
  ctx.strokeStyle = ctx.fillStyle = look.colour;
  ctx.lineWidth = look.width;
  ctx.lineJoin = "bevel";
  ctx.setLineDash(look.dash ?? []);
  const flush = () => {
    if (xs.length === 1) {
      xs.push(xs[0] + 1);
      highs.push(highs[0]);
      lows.push(lows[0]);
    }
    if (xs.length) {
      const path = outline(xs, highs, lows);
      ctx.globalAlpha = look.fill;
      ctx.fill(path);
      ctx.globalAlpha = 1;
      ctx.stroke(path);
    }
    xs = [];
    highs = [];
    lows = [];
  };
  let pixel = NaN;
  for (let i = from; i < to; i++) {
    if (Number.isNaN(high[i])) {
      flush();
      pixel = NaN;
      continue;
    }
    const x = map.x(times[i]);
    const y1 = map.y(high[i]);
    const y2 = map.y(low[i]);
    const last = xs.length - 1;
    if (Math.floor(x) === pixel) {
      if (y1 < highs[last]) highs[last] = y1;
      if (y2 > lows[last]) lows[last] = y2;
    } else {
      pixel = Math.floor(x);
      xs.push(x);
      highs.push(y1);
      lows.push(y2);
    }
  }
  flush();
  ctx.setLineDash([]);
}

/** Shades runs of bins; where several apply, they share the height. `found(i)` gives bits. */
export function paintShades(ctx, map, box, times, length, from, to, count, found, fill) {
  let bits = 0;
  let begin = 0;
  let pixel = NaN;
  let pixelBits = 0;
  const draw = (end) => {
    if (!bits) return;
    let parts = 0;
    for (let k = 0; k < count; k++) if (bits & (1 << k)) parts++;
    let nth = 0;
    for (let k = 0; k < count; k++) {
      if (!(bits & (1 << k))) continue;
      ctx.fillStyle = fill(k);
      ctx.fillRect(begin, box.top + (nth * box.height) / parts, Math.max(1, end - begin), box.height / parts);
      nth++;
    }
  };
  const step = () => {
    if (Number.isNaN(pixel) || pixelBits === bits) return;
    draw(pixel);
    bits = pixelBits;
    begin = pixel;
  };
  const half = length / 2;
  for (let i = from; i < to; i++) {
    const x = Math.max(box.left, Math.floor(map.x(times[i] - half)));
    if (x !== pixel) {
      step();
      pixel = x;
      pixelBits = 0;
    }
    pixelBits |= found(i);
  }
  step();
  if (to > from) draw(Math.min(box.left + box.width, Math.ceil(map.x(times[to - 1] + half))));
}

/** A line from top to bottom, with a head that is no colour alone. */
export function paintMark(ctx, x, box, colour, scale, head, size) {
  ctx.strokeStyle = ctx.fillStyle = colour;
  ctx.lineWidth = 1.5 * scale;
  ctx.setLineDash([4 * scale, 3 * scale]);
  ctx.beginPath();
  ctx.moveTo(x, box.top);
  ctx.lineTo(x, box.top + box.height);
  ctx.stroke();
  ctx.setLineDash([]);
  if (!head) return;
  ctx.font = `${size}px system-ui, sans-serif`;
  ctx.textBaseline = "top";
  const fits = x + ctx.measureText(head).width + 8 * scale < box.left + box.width;
  ctx.textAlign = fits ? "left" : "right";
  ctx.fillText(head, x + (fits ? 4 : -4) * scale, box.top + 2 * scale);
}
