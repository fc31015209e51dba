// Charts on canvas: lines of several runs over each other, with axes.

const DASHES = [[], [7, 3], [2, 2.5], [7, 3, 2, 3]];
const DEFAULT_MARGIN = { left: 52, right: 10, top: 8, bottom: 24 };

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

// A label from pieces [text, how it is set].
function label(pieces, unit = "") {
  const span = make("span");
  for (const [text, kind] of pieces) span.append(kind ? make(kind, {}, text) : text);
  if (unit) span.append(make("span", { className: "unit" }, ` (${unit})`));
  return span;
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// Numbers at even distances that are easy to read, and how they are written.
function ticks(low, high, most) {
  const raw = (high - low) / Math.max(1, most);
  if (!(raw > 0) || !Number.isFinite(raw)) return { at: [low], text: short };
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.8);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  const at = Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const large = Math.max(Math.abs(low), Math.abs(high));
  if (large < 1e5 && decimals <= 4) return { at, text: (v) => minus(v.toFixed(decimals)) };
  const digits = Math.min(2, Math.max(0, Math.floor(Math.log10(large)) - Math.floor(Math.log10(step) + 1e-9)));
  return { at, text: (v) => (v === 0 ? "0" : minus(v.toExponential(digits))) };
}

// The same for a logarithmic axis: powers of ten, of which some are left out where they are many.
function decades(low, high, most) {
  const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  const every = Math.max(1, Math.ceil((last - first + 1) / Math.max(1, most)));
  const powers = Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => 10 ** (first + i)).filter((_, i) => i % every === 0);
  const between = last > first ? [] : [first - 1, first].flatMap((n) => [2 * 10 ** n, 5 * 10 ** n]);
  const at = [...new Set([...powers, ...between])].filter((v) => v >= low && v <= high).sort((a, b) => a - b);
  return { at, text: short };
}

function minus(text) {
  return text.replaceAll("-", "\u2212");
}

// Four digits, as %.4g.
function short(value) {
  if (!Number.isFinite(value)) return "\u2013";
  return minus(String(Number(value.toPrecision(4))));
}

// As many decimals as the step from one code to the next is worth, and no more than seven digits.
function exact(value, step) {
  if (!Number.isFinite(value)) return "\u2013";
  if (!(step > 0)) return short(value);
  const decimals = Math.ceil(-Math.log10(step));
  if (decimals < 0 || decimals > 9) return minus(String(Number(value.toPrecision(7))));
  const before = Math.max(1, Math.ceil(Math.log10(Math.abs(value) + 1e-300)));
  const text = value.toFixed(Math.min(decimals, Math.max(0, 7 - before)));
  return minus(Number(text) === 0 ? text.replace("-", "") : text);
}

// A canvas that fills its place, at the resolution of the screen.
class Sheet {
  constructor(place, height, redraw) {
    this.canvas = make("canvas", { role: "img" });
    this.place = place;
    this.height = height;
    place.append(this.canvas);
    new ResizeObserver(() => {
      if (place.clientWidth !== this.width) redraw();
    }).observe(place);
  }

  begin(height = this.height) {
    this.width = this.place.clientWidth;
    this.height = height;
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.canvas.style.height = `${height}px`;
    const pen = this.canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, this.width, height);
    pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    pen.lineJoin = "round";
    return pen;
  }
}

class Chart {
  // actions: point(x) under the pointer, x null when it leaves; pick(x) where it is pressed.
  constructor(place, height, actions) {
    this.sheet = new Sheet(place, height, () => this.draw());
    this.margin = DEFAULT_MARGIN;
    const value = (event) => {
      const { left } = this.sheet.canvas.getBoundingClientRect();
      const [low, high] = this.content.across;
      const { left: start, right } = this.margin;
      return low + ((event.clientX - left - start) / (this.sheet.width - start - right)) * (high - low);
    };
    const canvas = this.sheet.canvas;
    canvas.addEventListener("pointermove", (event) => {
      actions.point(value(event));
      if (event.buttons && actions.pick) actions.pick(value(event));
    });
    canvas.addEventListener("pointerdown", (event) => (actions.pick || actions.point)(value(event)));
    canvas.addEventListener("pointerleave", () => actions.point(null));
  }

  // across, up: ranges; log: of up; lines: x, y, colour, dash, and floor where they are filled; cursor: x; level: y
  show(content) {
    this.content = content;
    this.draw();
  }

  draw() {
    if (!this.content) return;
    const pen = this.sheet.begin();
    const { across, up, log, lines, cursor, level } = this.content;
    const { left, right, top, bottom } = this.margin;
    const w = this.sheet.width - left - right;
    const h = this.sheet.height - top - bottom;
    if (w < 20) return;
    const px = (x) => left + ((x - across[0]) / (across[1] - across[0] || 1)) * w;
    const scale = log ? (y) => (y > 0 ? Math.log(y) : NaN) : (y) => y;
    const [foot, head] = up.map(scale);
    const py = (y) => top + h - ((scale(y) - foot) / (head - foot || 1)) * h;
    this.axes(pen, { px, py, w, h });
    pen.save();
    pen.beginPath();
    pen.rect(left, top, w, h);
    pen.clip();
    if (level !== null && level !== undefined) stroke(pen, [[left, py(level)], [left + w, py(level)]], colour("faint"), 1, [4, 3]);
    for (const line of lines) drawLine(pen, line, px, py);
    if (cursor !== null && cursor !== undefined) stroke(pen, [[px(cursor), top], [px(cursor), top + h]], colour("cursor"), 1);
    pen.restore();
  }

  axes(pen, { px, py, w, h }) {
    const { across, up, log } = this.content;
    const { left, top } = this.margin;
    pen.fillStyle = colour("quiet");
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const vertical = (log ? decades : ticks)(up[0], up[1], Math.max(2, Math.floor(h / 28)));
    for (const y of vertical.at) {
      stroke(pen, [[left, py(y)], [left + w, py(y)]], colour("grid"), 1);
      pen.fillText(vertical.text(y), left - 6, py(y));
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const horizontal = ticks(across[0], across[1], Math.max(2, Math.floor(w / 70)));
    for (const x of horizontal.at) {
      stroke(pen, [[px(x), top + h], [px(x), top + h + 4]], colour("faint"), 1);
      const text = horizontal.text(x);
      const over = Math.max(0, px(x) + pen.measureText(text).width / 2 - this.sheet.width);
      pen.fillText(text, px(x) - over, top + h + 7);
    }
    stroke(pen, [[left, top + h], [left + w, top + h]], colour("faint"), 1);
  }
}

function stroke(pen, points, style, width, dash = []) {
  pen.beginPath();
  for (const [x, y] of points) pen.lineTo(x, y);
  pen.setLineDash(dash);
  pen.strokeStyle = style;
  pen.lineWidth = width;
  pen.stroke();
  pen.setLineDash([]);
}

// A line that leaves a gap where there is no number, or none that its axis has; one number alone is a dot.
function drawLine(pen, { x, y, floor, style, dash }, px, py) {
  const high = Float64Array.from(y, py);
  pen.strokeStyle = pen.fillStyle = style;
  pen.lineWidth = 1.6;
  let start = 0;
  while (start < high.length) {
    if (!Number.isFinite(high[start])) {
      start += 1;
      continue;
    }
    let end = start;
    while (end + 1 < high.length && Number.isFinite(high[end + 1])) end += 1;
    pen.beginPath();
    for (let i = start; i <= end; i += 1) pen.lineTo(px(x[i]), high[i]);
    pen.setLineDash(dash);
    pen.stroke();
    pen.setLineDash([]);
    if (start === end) pen.fillRect(px(x[start]) - 1.5, high[start] - 1.5, 3, 3);
    if (floor) {
      for (let i = end; i >= start; i -= 1) pen.lineTo(px(x[i]), py(floor[i]));
      pen.globalAlpha = 0.14;
      pen.fill();
      pen.globalAlpha = 1;
    }
    start = end + 1;
  }
}

// A range with a little air, at least `span` wide, and wide enough that rounding is no signal.
function roomy([low, high], span, zero = false) {
  const wide = Math.max(high - low, span, 0.02 * Math.max(Math.abs(low), Math.abs(high))) || 1;
  const middle = (low + high) / 2;
  const half = (wide / 2) * 1.08;
  return zero ? [0, Math.max(high * 1.08, wide)] : [middle - half, middle + half];
}
