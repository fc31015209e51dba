// The mass on its bed: tilted, as it lies on the slope, or flat, along the slope.

const TILTED_PAD = 26;

class Flow {
  constructor(place, point) {
    this.place = place;
    this.chart = new Chart(make("div"), 240, { point });
    this.flat = this.chart.sheet.place;
    this.tilted = make("div");
    place.append(this.tilted, this.flat);
    this.sheet = new Sheet(this.tilted, 240, () => this.draw());
    const there = (event) => {
      const box = this.sheet.canvas.getBoundingClientRect();
      point(this.along ? this.along(event.clientX - box.left, event.clientY - box.top) : null);
    };
    this.sheet.canvas.addEventListener("pointermove", there);
    this.sheet.canvas.addEventListener("pointerdown", there);
    this.sheet.canvas.addEventListener("pointerleave", () => point(null));
  }

  // Each layer: run, h at the instant, colour, dash; cursor: x in metres or null. Returns the exaggeration.
  show(layers, tilted, cursor, position, panel) {
    Object.assign(this, { layers, cursor, position });
    this.tilted.hidden = !tilted;
    this.flat.hidden = tilted;
    if (tilted) return this.draw();
    const lines = [];
    const tops = [];
    let low = 0;
    for (const { run, h, style, dash } of layers) {
      const x = run.x.map((v) => v * position.factor);
      const floor = run.bed.map((v) => v * panel.factor);
      const [least, most] = extent([floor]);
      low = Math.min(low, least);
      tops.push(most + run.deepest * panel.factor);
      lines.push({ x, y: h.map((v, i) => v * panel.factor + floor[i]), floor, style, dash });
      if (most > least) lines.push({ x, y: floor, style: colour("quiet"), dash: [] });
    }
    const high = Math.max(...tops, low + panel.span);
    const across = extent(lines.map((line) => [line.x[0], line.x[line.x.length - 1]]));
    const at = cursor === null ? null : cursor * position.factor;
    this.chart.show({ across, up: [low, low + (high - low) * 1.06], lines, cursor: at });
    return 1;
  }

  draw() {
    if (!this.layers?.length || this.tilted.hidden) return 1;
    const width = this.place.clientWidth;
    const places = this.layers.map(({ run }) => ({
      run,
      cos: Math.cos((run.angle * Math.PI) / 180),
      sin: Math.sin((run.angle * Math.PI) / 180),
    }));
    // The drawing is as wide as its place, and at most 400 pixels high.
    const bounds = (times) => {
      const xs = [];
      const ys = [];
      for (const { run, cos, sin } of places) {
        run.x.forEach((s, i) => {
          for (const n of [run.bed[i], run.bed[i] + run.envelope[i]]) {
            xs.push(s * cos + times * n * sin);
            ys.push(-s * sin + times * n * cos);
          }
        });
      }
      const [x0, x1] = extent([xs]);
      const [y0, y1] = extent([ys]);
      const room = width - 2 * TILTED_PAD;
      const scale = Math.min(room / (x1 - x0 || 1), 400 / (y1 - y0 || 1));
      return { x0, y1, scale, high: (y1 - y0) * scale, shift: (room - (x1 - x0) * scale) / 2 };
    };
    const deepest = Math.max(...this.layers.map(({ run }) => run.deepest));
    const times = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((t) => t * deepest * bounds(t).scale >= 56) || 1;
    const { x0, y1, scale, high, shift } = bounds(times);
    const pen = this.sheet.begin(Math.max(120, Math.round(high + 2 * TILTED_PAD + 8)));
    const point = ({ cos, sin }, s, n) => [
      TILTED_PAD + shift + (s * cos + times * n * sin - x0) * scale,
      TILTED_PAD - 10 + (y1 + s * sin - times * n * cos) * scale,
    ];
    const first = places[0];
    this.along = (px, py) => {
      const X = (px - TILTED_PAD - shift) / scale + x0;
      const Y = y1 - (py - TILTED_PAD + 10) / scale;
      return X * first.cos - Y * first.sin;
    };
    const beds = places.map((place) => Array.from(place.run.x, (s, k) => point(place, s, place.run.bed[k])));
    const same = (a, b) => a.length === b.length && a.every(([x, y], k) => x === b[k][0] && y === b[k][1]);
    beds.forEach((bed, i) => {
      if (!beds.slice(0, i).some((other) => same(other, bed))) this.ground(pen, places[i], bed);
    });
    this.layers.forEach(({ run, h, style, dash }, i) => {
      const [place, bed] = [places[i], beds[i]];
      const top = Array.from(run.x, (s, k) => point(place, s, run.bed[k] + (h[k] || 0)));
      pen.beginPath();
      for (const [x, y] of [...top, ...[...bed].reverse()]) pen.lineTo(x, y);
      pen.fillStyle = style;
      pen.globalAlpha = this.layers.length === 1 ? 0.3 : 0.14;
      pen.fill();
      pen.globalAlpha = 1;
      stroke(pen, top, style, 1.6, dash);
    });
    this.numbers(pen, first, point);
    if (this.cursor !== null) {
      const run = first.run;
      const b = run.bed[nearest(run.x, this.cursor)];
      stroke(pen, [point(first, this.cursor, b), point(first, this.cursor, b + 1.1 * deepest)], colour("cursor"), 1);
    }
    return times;
  }

  // The bed with a shade below it.
  ground(pen, { cos, sin }, bed) {
    const below = bed.map(([x, y]) => [x - 7 * sin, y + 7 * cos]).reverse();
    pen.beginPath();
    for (const [x, y] of [...bed, ...below]) pen.lineTo(x, y);
    pen.fillStyle = colour("ground");
    pen.fill();
    stroke(pen, bed, colour("quiet"), 1);
  }

  // Positions along the bed.
  numbers(pen, place, point) {
    const { run, cos, sin } = place;
    const { factor } = this.position;
    const ends = [run.x[0] * factor, run.x[run.x.length - 1] * factor];
    const marks = ticks(ends[0], ends[1], Math.max(2, Math.floor(this.sheet.width / 110)));
    pen.fillStyle = colour("quiet");
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const at of marks.at) {
      const [x, y] = point(place, at / factor, run.bed[nearest(run.x, at / factor)]);
      stroke(pen, [[x, y], [x - 11 * sin, y + 11 * cos]], colour("quiet"), 1);
      pen.fillText(marks.text(at), x - 14 * sin, y + 10 * cos + 3);
    }
  }
}
