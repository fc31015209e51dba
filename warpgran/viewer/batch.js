// The runs of a batch: parallel coordinates with ranges, and a table.

const ROW_HEIGHT = 30;
const AXIS_WIDTH = 104;

// What a run's results are to be read with, in a word each, and in words.
const RESERVES = {
  left_grid: { sign: "\u25b2", word: "left the grid", said: "it lost solid through an end of the grid, so that its run-out is a lower bound" },
  moving: { sign: "\u25cb", word: "moving", said: "it had not stopped at the end, so that its run-out is not final" },
};

class Batch {
  // table: as written; pick(row, add): a run was chosen; changed(): ranges or order did.
  constructor(table, files, { pick, changed }) {
    Object.assign(this, { table, files, pick, changed, keep: {}, sort: "", down: false, shown: new Map(), cursor: 0 });
    this.columns = table.columns.map((column) => new Column(column));
    this.rows = Array.from(table.run, (_, row) => row);
    this.reserves = Object.fromEntries(Object.keys(RESERVES).map((name) => [name, new Set(table[name])]));
    this.parallel = document.getElementById("parallel");
    this.box = document.getElementById("table");
  }

  build() {
    this.buildParallel();
    this.buildRanges();
    this.buildTable();
  }

  name(row) {
    const { file, run } = this.table;
    const many = new Set(file).size > 1;
    return `${many ? `${this.files[file[row]]} ` : ""}run ${run[row]}`;
  }

  // Words of status and reserves of a run.
  remarks(row) {
    const status = this.table.status[row];
    const words = status === "ok" ? [] : [status.replace("_", " ")];
    for (const [name, rows] of Object.entries(this.reserves)) if (rows.has(row)) words.push(RESERVES[name].word);
    return words;
  }

  kept() {
    const ranges = Object.entries(this.keep).map(([name, range]) => [this.columns.find((c) => c.name === name), range]);
    return this.rows.filter((row) => ranges.every(([column, [low, high]]) => column.at[row] >= low && column.at[row] <= high));
  }

  ordered() {
    const rows = this.kept();
    const value = this.order(this.sort);
    if (!value) return rows;
    const sign = this.down ? -1 : 1;
    return rows.sort((a, b) => {
      const [u, v] = [value(a), value(b)];
      const gaps = Number(Number.isNaN(u)) - Number(Number.isNaN(v));
      return gaps || (u === v || gaps ? a - b : sign * (u < v ? -1 : 1));
    });
  }

  order(name) {
    if (name === "run") return (row) => this.table.run[row];
    if (name === "file") return (row) => this.table.file[row];
    if (name === "status") return (row) => `${this.table.status[row]} ${this.remarks(row).join(" ")}`;
    const column = this.columns.find((c) => c.name === name);
    return column && ((row) => column.at[row]);
  }

  update(shown) {
    this.shown = shown;
    this.list = this.ordered();
    this.cursor = Math.max(0, Math.min(this.cursor, this.list.length - 1));
    const [kept, all] = [this.list.length, this.rows.length];
    document.getElementById("counted").textContent = kept < all ? `${kept} of ${all} runs` : `${all} runs`;
    this.drawParallel();
    this.drawRanges();
    this.drawRows();
  }

  change() {
    this.update(this.shown);
    this.changed();
  }

  // ---- parallel coordinates

  buildParallel() {
    const inner = make("div", { className: "inner" });
    inner.style.minWidth = `${AXIS_WIDTH * this.columns.length}px`;
    this.names = make("div", { className: "names" });
    for (const column of this.columns) this.names.append(make("div", {}, label(column.label, column.unit)));
    inner.append(this.names);
    this.parallel.append(inner);
    if (!this.columns.some((column) => column.kind === "key")) {
      this.parallel.closest("figure").hidden = true;
      document.getElementById("ranges").hidden = true;
    }
    this.sheet = new Sheet(inner, 220, () => this.drawParallel());
    this.sheet.canvas.setAttribute("aria-label", "parameters and outcomes of all runs");
    const canvas = this.sheet.canvas;
    let drag = null;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener("pointerdown", (event) => {
      const [x, y] = place(event);
      const axis = this.columns.findIndex((_, i) => Math.abs(this.axisX(i) - x) < 16);
      if (axis < 0) return this.pickLine(x, y, event.shiftKey || event.ctrlKey || event.metaKey);
      drag = { column: this.columns[axis], from: y, moved: false };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!drag) return;
      const y = place(event)[1];
      if (Math.abs(y - drag.from) > 4) drag.moved = true;
      if (!drag.moved) return;
      const [a, b] = [drag.column.value(this.share(drag.from)), drag.column.value(this.share(y))];
      this.keep[drag.column.name] = [Math.min(a, b), Math.max(a, b)];
      cancelAnimationFrame(this.waiting);
      this.waiting = requestAnimationFrame(() => this.update(this.shown));
    });
    canvas.addEventListener("pointerup", () => {
      if (!drag) return;
      if (!drag.moved) delete this.keep[drag.column.name];
      drag = null;
      cancelAnimationFrame(this.waiting);
      this.change();
    });
  }

  axisX(i) {
    return ((i + 0.5) * this.sheet.width) / this.columns.length;
  }

  // Of a height on an axis: 0 at its foot, 1 at its head.
  share(y) {
    return Math.min(1, Math.max(0, (this.foot - y) / (this.foot - 12)));
  }

  axisY(column, row) {
    const share = column.share(column.at[row]);
    return Number.isNaN(share) ? this.foot + 16 : this.foot - share * (this.foot - 12);
  }

  line(pen, row) {
    pen.beginPath();
    this.columns.forEach((column, i) => pen.lineTo(this.axisX(i), this.axisY(column, row)));
    pen.stroke();
  }

  drawParallel() {
    if (!this.list) return;
    const pen = this.sheet.begin();
    if (!this.sheet.width) return;
    this.foot = this.sheet.height - 24;
    const kept = new Set(this.list);
    pen.lineWidth = 1;
    pen.strokeStyle = colour("grid");
    if (kept.size < this.rows.length) for (const row of this.rows) if (!kept.has(row)) this.line(pen, row);
    pen.strokeStyle = colour("many");
    pen.globalAlpha = Math.min(0.7, Math.max(0.05, 24 / kept.size));
    for (const row of kept) this.line(pen, row);
    pen.globalAlpha = 1;
    for (const [row, { style, dash }] of this.shown) {
      pen.strokeStyle = style;
      pen.lineWidth = 2.4;
      pen.setLineDash(dash);
      this.line(pen, row);
      pen.setLineDash([]);
    }
    this.columns.forEach((column, i) => this.drawAxis(pen, column, this.axisX(i)));
  }

  drawAxis(pen, column, x) {
    stroke(pen, [[x, 12], [x, this.foot]], colour("quiet"), 1);
    const range = this.keep[column.name];
    if (range) {
      const [low, high] = range.map((v) => this.foot - column.share(v) * (this.foot - 12));
      pen.fillStyle = colour("accent");
      pen.globalAlpha = 0.25;
      pen.fillRect(x - 7, high, 14, Math.max(2, low - high));
      pen.globalAlpha = 1;
    }
    pen.textBaseline = "middle";
    pen.lineWidth = 3;
    pen.strokeStyle = colour("paper");
    pen.fillStyle = colour("text");
    const marks = column.marks().map(([share, text]) => [this.foot - share * (this.foot - 12), text]);
    if (column.gaps) marks.push([this.foot + 16, "none"]);
    for (const [y, text] of marks) {
      const fits = x + 6 + pen.measureText(text).width <= this.sheet.width;
      pen.textAlign = fits ? "left" : "right";
      pen.strokeText(text, x + (fits ? 6 : -6), y);
      pen.fillText(text, x + (fits ? 6 : -6), y);
    }
  }

  pickLine(x, y, add) {
    let best = null;
    let least = 8;
    for (const row of this.list) {
      for (let i = 0; i + 1 < this.columns.length; i += 1) {
        const [x0, x1] = [this.axisX(i), this.axisX(i + 1)];
        if (x < x0 || x > x1) continue;
        const [y0, y1] = [this.axisY(this.columns[i], row), this.axisY(this.columns[i + 1], row)];
        const away = Math.abs(y0 + ((y1 - y0) * (x - x0)) / (x1 - x0) - y) / Math.hypot(1, (y1 - y0) / (x1 - x0));
        if (away < least) [least, best] = [away, row];
      }
    }
    if (best !== null) this.pick(best, add);
  }

  // ---- ranges as numbers, for the keyboard

  buildRanges() {
    const place = document.querySelector("#ranges > div");
    this.fields = this.columns.filter((c) => c.numeric).map((column) => {
      const ends = ["from", "to"].map((end) => make("input", { type: "number", step: "any", placeholder: end, "aria-label": `${column.text} ${end}` }));
      ends.forEach((field) => field.addEventListener("change", () => {
        const [low, high] = ends.map((e) => (e.value === "" ? NaN : Number(e.value)));
        if (Number.isNaN(low) && Number.isNaN(high)) delete this.keep[column.name];
        else this.keep[column.name] = [Number.isNaN(low) ? -Infinity : low, Number.isNaN(high) ? Infinity : high];
        this.change();
      }));
      place.append(make("div", {}, label(column.label, column.unit), make("span", {}, ...ends)));
      return [column, ends];
    });
    const clear = make("button", { type: "button" }, "Keep all runs");
    clear.addEventListener("click", () => {
      this.keep = {};
      this.change();
    });
    place.append(clear);
  }

  drawRanges() {
    for (const [column, ends] of this.fields) {
      const range = this.keep[column.name] || [NaN, NaN];
      ends.forEach((field, i) => {
        if (field !== document.activeElement) field.value = Number.isFinite(range[i]) ? Number(range[i].toPrecision(4)) : "";
      });
    }
  }

  // ---- the table

  buildTable() {
    const many = new Set(this.table.file).size > 1;
    this.heads = [["run", "run"], ...(many ? [["file", "file"]] : []), ["status", "status"], ...this.columns.map((c) => [c.name, c])];
    const head = make("tr", { className: "head" }, make("th", { "aria-label": "shown" }));
    for (const [name, column] of this.heads) {
      const button = make("button", { type: "button" }, column.label ? label(column.label, column.unit) : column);
      button.addEventListener("click", () => {
        this.down = this.sort === name ? !this.down : false;
        this.sort = name;
        this.change();
      });
      head.append(make("th", { scope: "col", "data-name": name, className: column.numeric === false || name === "status" || name === "file" ? "left" : "" }, button));
    }
    this.body = make("tbody");
    this.grid = make("table", { role: "grid", tabIndex: 0, "aria-label": "Runs", "aria-multiselectable": "true" }, make("thead", {}, head), this.body);
    this.box.append(this.grid);
    this.box.addEventListener("scroll", () => this.drawRows());
    this.grid.addEventListener("keydown", (event) => this.key(event));
    this.body.addEventListener("click", (event) => {
      const row = event.target.closest("tr[data-row]");
      if (!row) return;
      this.cursor = this.list.indexOf(Number(row.dataset.row));
      this.pick(Number(row.dataset.row), Boolean(event.target.closest(".add")) || event.shiftKey || event.ctrlKey || event.metaKey);
    });
  }

  key(event) {
    const move = { ArrowUp: -1, ArrowDown: 1, PageUp: -8, PageDown: 8 }[event.key];
    if (event.target !== this.grid) return;
    if (move) {
      this.cursor = Math.min(this.list.length - 1, Math.max(0, this.cursor + move));
      const [top, high] = [this.cursor * ROW_HEIGHT, this.box.clientHeight - 3 * ROW_HEIGHT];
      if (top < this.box.scrollTop) this.box.scrollTop = top;
      if (top > this.box.scrollTop + high) this.box.scrollTop = top - high;
      this.drawRows();
    } else if (["Enter", "+"].includes(event.key) && this.list.length) {
      this.pick(this.list[this.cursor], event.key === "+");
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  // Only the rows in sight are in the document.
  drawRows() {
    const first = Math.max(0, Math.floor(this.box.scrollTop / ROW_HEIGHT) - 4);
    const last = Math.min(this.list.length, first + Math.ceil((this.box.clientHeight || 300) / ROW_HEIGHT) + 8);
    const gap = (rows) => {
      const row = make("tr", { "aria-hidden": "true" }, make("td", { colSpan: this.heads.length + 1 }));
      row.firstChild.style.height = `${rows * ROW_HEIGHT}px`;
      return row;
    };
    const rows = this.list.slice(first, last).map((row, i) => this.row(row, first + i));
    this.body.replaceChildren(...(first ? [gap(first)] : []), ...rows, ...(last < this.list.length ? [gap(this.list.length - last)] : []));
    for (const th of this.box.querySelectorAll("th[data-name]")) {
      if (th.dataset.name === this.sort) th.setAttribute("aria-sort", this.down ? "descending" : "ascending");
      else th.removeAttribute("aria-sort");
    }
    this.grid.setAttribute("aria-rowcount", this.list.length + 1);
    if (last > this.cursor && this.cursor >= first) this.grid.setAttribute("aria-activedescendant", `row-${this.list[this.cursor]}`);
    else this.grid.removeAttribute("aria-activedescendant");
  }

  row(row, place) {
    const shown = this.shown.get(row);
    const absent = !document.getElementById(`run-${row}`);
    const add = make("button", { type: "button", tabIndex: -1, className: "add", "aria-pressed": Boolean(shown), "aria-label": `show ${this.name(row)} beside the others` }, shown ? "\u25cf" : "+");
    if (shown) add.style.color = shown.style;
    const cells = [make("td", {}, add)];
    for (const [name, column] of this.heads) {
      const left = column.numeric === false || name === "status" || name === "file";
      cells.push(make("td", { className: left ? "left" : "" }, ...this.cell(row, name, column)));
    }
    const classes = [shown ? "shown" : "", absent ? "absent" : "", place === this.cursor ? "cursor" : ""].join(" ");
    return make("tr", { id: `row-${row}`, "data-row": row, "aria-rowindex": place + 2, "aria-selected": Boolean(shown), className: classes, title: absent ? "its profiles are not in this page" : "" }, ...cells);
  }

  cell(row, name, column) {
    if (name === "run") return [String(this.table.run[row])];
    if (name === "file") return [this.files[this.table.file[row]]];
    if (name !== "status") {
      const bound = name === "run_out" && this.reserves.left_grid.has(row) ? "\u2265 " : "";
      return [bound + column.word(row)];
    }
    const signs = Object.entries(this.reserves).filter(([, rows]) => rows.has(row)).map(([key]) => RESERVES[key].sign);
    const clean = ["ok", "at_rest"].includes(this.table.status[row]);
    const words = [...(clean ? [] : ["\u00d7"]), ...signs, this.remarks(row).join(", ") || "ok"];
    return [words.join(" "), ...(this.table.failure[row] ? [make("span", { className: "quiet" }, `: ${this.table.failure[row]}`)] : [])];
  }
}

// A key or an outcome: numbers, or words that are numbered.
class Column {
  constructor(column) {
    Object.assign(this, column);
    this.text = this.label.map(([text]) => text).join("");
    this.numeric = !column.words;
    this.levels = this.numeric ? [] : [...new Set(column.words)].sort();
    this.at = this.numeric ? column.values.map((v) => (v === null ? NaN : v)) : column.words.map((w) => this.levels.indexOf(w));
    this.gaps = this.at.some(Number.isNaN);
    const [low, high] = this.numeric ? extent([this.at]) : [-0.5, this.levels.length - 0.5];
    this.single = !(low < high);
    this.range = this.single ? [low - 0.5, high + 0.5] : [low, high];
  }

  share(value) {
    const [low, high] = this.range;
    if (value <= low) return 0;
    if (value >= high) return 1;
    return this.log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  }

  value(share) {
    const [low, high] = this.range;
    return this.log ? low * (high / low) ** share : low + share * (high - low);
  }

  word(row) {
    return this.numeric ? short(this.at[row]) : this.levels[this.at[row]];
  }

  marks() {
    if (!this.numeric) return this.levels.map((word, i) => [this.share(i), word]);
    const middle = this.value(0.5);
    const [low, high] = this.range;
    const text = (v) => minus(String(Number((Math.abs(v) < 1e-9 * (high - low) ? 0 : v).toPrecision(3))));
    return this.single ? [[0.5, text(middle)]] : [[0, text(low)], [0.5, text(middle)], [1, text(high)]];
  }
}
