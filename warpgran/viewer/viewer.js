// The page: which runs are shown, at which time, and how; all of it stands in the address.

const MOST_SHOWN = 4;
const WRITE_EVERY = 400; // milliseconds between two changes of the address: browsers refuse more than some
const byId = (id) => document.getElementById(id);
const head = JSON.parse(byId("head").textContent);
const state = { rows: [], time: null, tilted: true, place: null, linear: false, theme: "" };
const cache = new Map();
let batch = null;
let table = null;
let runs = []; // as drawn: { row, run, style, dash }
let times = [0];
let flow = null;
let hovered = null; // time under the pointer in a series
let playing = 0;
let missed = "";
const charts = { profiles: [], series: [] };

// ---- start

async function start() {
  table = (await unpack("table-data")).head;
  batch = new Batch(table, head.files, { pick, changed: remember });
  byId("batch").hidden = table.run.length < 2;
  batch.build();
  build();
  await restore();
  window.addEventListener("hashchange", () => {
    if (location.hash !== written) restore();
  });
}

function build() {
  flow = new Flow(document.querySelector("#flow .canvas"), point);
  for (const panel of head.profiles) charts.profiles.push(panelOf(byId("profiles"), panel, { point: (x) => point(x === null ? null : x / head.position.factor) }));
  head.series.forEach((panel, i) => {
    const actions = { point: look, pick: (t) => goTo(nearest(times, t)) };
    charts.series.push(panelOf(byId(i < head.first_series ? "series" : "more-series"), panel, actions));
  });
  byId("slider").addEventListener("input", (event) => goTo(Number(event.target.value)));
  byId("play").addEventListener("click", play);
  byId("tilt").addEventListener("click", tilt);
  byId("log").addEventListener("click", bend);
  byId("theme").addEventListener("click", turn);
  window.addEventListener("beforeprint", () => paint("light"));
  window.addEventListener("afterprint", () => paint(state.theme));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => draw());
  document.addEventListener("keydown", key);
}

function panelOf(place, panel, actions) {
  const values = make("span", { className: "values" });
  const canvas = make("div", { className: "canvas" });
  const figure = make("figure", { "data-name": panel.name }, make("figcaption", {}, label(panel.label, panel.unit), values), canvas);
  place.append(figure);
  const chart = new Chart(canvas, 150, actions);
  return { panel, values, chart };
}

// ---- the address

let written = "";
let due = 0;

function remember() {
  if (!due) due = setTimeout(write, WRITE_EVERY);
}

function write() {
  due = 0;
  const parts = new URLSearchParams();
  parts.set("run", state.rows.map((row) => `${table.file[row]}.${table.run[row]}`).join(","));
  if (state.time !== null) parts.set("t", String(Number(state.time.toPrecision(9))));
  if (!state.tilted) parts.set("view", "flat");
  if (state.place !== null) parts.set("x", String(Number(state.place.toPrecision(9))));
  if (state.linear) parts.set("axes", "linear");
  if (state.theme) parts.set("theme", state.theme);
  if (batch.sort) parts.set("sort", (batch.down ? "-" : "") + batch.sort);
  const keep = Object.entries(batch.keep).map(([name, range]) => [name, ...range.map((v) => Number(v.toPrecision(6)))].join("~"));
  if (keep.length) parts.set("keep", keep.join(","));
  written = `#${parts}`;
  history.replaceState(null, "", written);
}

async function restore() {
  clearTimeout(due);
  due = 0;
  const parts = new URLSearchParams(location.hash.slice(1));
  const asked = (parts.get("run") || "").split(",").map((name) => {
    const [file, run] = name.split(".").map(Number);
    return table.run.findIndex((r, row) => r === run && table.file[row] === file);
  });
  const rows = asked.filter((row) => row >= 0);
  const number = (name) => (parts.has(name) && Number.isFinite(Number(parts.get(name))) ? Number(parts.get(name)) : null);
  state.time = number("t");
  state.tilted = parts.get("view") !== "flat";
  state.place = number("x");
  state.linear = parts.get("axes") === "linear";
  state.theme = ["light", "dark"].includes(parts.get("theme")) ? parts.get("theme") : "";
  const sort = parts.get("sort") || "";
  batch.down = sort.startsWith("-");
  batch.sort = sort.replace(/^-/, "");
  batch.keep = {};
  for (const item of (parts.get("keep") || "").split(",").filter(Boolean)) {
    const [name, low, high] = item.split("~");
    if (batch.columns.some((c) => c.name === name) && Number(low) <= Number(high)) batch.keep[name] = [Number(low), Number(high)];
  }
  if (state.theme) document.documentElement.dataset.theme = state.theme;
  else delete document.documentElement.dataset.theme;
  await show(rows.length ? rows : firstRows());
}

// One run of each of up to four files, else the first run that has profiles.
function firstRows() {
  const there = table.run.map((_, row) => row).filter((row) => byId(`run-${row}`));
  const rows = [...new Map(there.map((row) => [table.file[row], row]).reverse()).values()];
  return rows.sort((a, b) => a - b).slice(0, MOST_SHOWN);
}

// ---- which runs

function pick(row, add) {
  if (!add) return show([row]);
  const without = state.rows.filter((other) => other !== row);
  if (without.length < state.rows.length) return without.length ? show(without) : undefined;
  return show([...state.rows, row].slice(-MOST_SHOWN));
}

async function show(rows) {
  const absent = rows.filter((row) => !byId(`run-${row}`));
  missed = absent.map((row) => `The profiles of ${batch.name(row)} are not in this page: warpgran view --runs ${table.run[row]}`).join(" ");
  const wanted = rows.filter((row) => byId(`run-${row}`)).slice(0, MOST_SHOWN);
  if (!wanted.length) return draw();
  state.rows = wanted;
  for (const row of wanted) {
    if (!cache.has(row)) cache.set(row, await unpackRun(row, head.series.map((panel) => panel.name)));
  }
  if (state.rows !== wanted) return undefined; // another choice came in between
  for (const row of [...cache.keys()].slice(0, -16)) if (!wanted.includes(row)) cache.delete(row);
  const union = (name) => [...new Set(wanted.flatMap((row) => cache.get(row)[name]))].sort((a, b) => a - b);
  times = union("time");
  if (!times.length) times = union("series_time");
  if (!times.length) times = [0];
  const first = state.time === null ? Math.floor((times.length - 1) / 2) : nearest(times, state.time);
  state.time = times[first];
  byId("slider").max = times.length - 1;
  return draw();
}

// ---- time and place

function goTo(index) {
  state.time = times[Math.min(times.length - 1, Math.max(0, index))];
  drawRuns();
  remember();
}

function now() {
  return nearest(times, state.time);
}

function play() {
  if (playing) {
    clearTimeout(playing);
    playing = 0;
  } else {
    if (now() === times.length - 1) goTo(0);
    tick();
  }
  byId("play").textContent = playing ? "\u2759\u2759" : "\u25b6";
  byId("play").setAttribute("aria-label", playing ? "Pause" : "Play");
}

// On to the next snapshot after a share of the 8 s, or fewer, that all take: as time passes, however they are spaced.
function tick() {
  const last = times.length - 1;
  const whole = Math.max(40 * last, Math.min(400 * last, 8000));
  const share = (times[now() + 1] - times[now()]) / (times[last] - times[0]);
  playing = setTimeout(() => {
    goTo(now() + 1);
    if (now() < last) tick();
    else play();
  }, whole * share || 0);
}

// x in metres, null where the pointer has left.
function point(x) {
  state.place = x;
  drawRuns();
  remember();
}

function look(t) {
  hovered = t;
  drawSeries();
}

function tilt() {
  state.tilted = !state.tilted;
  draw();
}

// Speeds and inertial numbers on logarithmic axes, or on linear ones.
function bend() {
  state.linear = !state.linear;
  draw();
}

function dark() {
  const theme = document.documentElement.dataset.theme;
  return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

// In a theme that is not always that of the state: paper is white.
function paint(theme) {
  if (theme) document.documentElement.dataset.theme = theme;
  else delete document.documentElement.dataset.theme;
  draw();
}

function turn() {
  state.theme = dark() ? "light" : "dark";
  paint(state.theme);
}

function step(by) {
  const { run } = runs[0];
  const from = state.place === null ? run.x[Math.floor(run.x.length / 2)] : state.place;
  const i = Math.min(run.x.length - 1, Math.max(0, nearest(run.x, from) + by));
  point(run.x[i]);
}

function key(event) {
  const tag = event.target.tagName;
  const typing = tag === "INPUT" && event.target.type !== "range";
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const onControl = ["BUTTON", "SUMMARY"].includes(tag);
  const actions = {
    ArrowLeft: () => (event.shiftKey ? step(-1) : goTo(now() - 1)),
    ArrowRight: () => (event.shiftKey ? step(1) : goTo(now() + 1)),
    Home: () => goTo(0),
    End: () => goTo(times.length - 1),
    Escape: () => point(null),
    " ": onControl ? null : play,
    t: tilt,
    l: bend,
    d: turn,
  };
  const action = actions[event.key] || actions[event.key.toLowerCase()];
  if (!action || !runs.length) return;
  action();
  event.preventDefault();
}

// ---- drawing

function styleOf(i) {
  const base = head.colours[i];
  if (!dark()) return base;
  const mix = [1, 3, 5].map((k) => Math.round(parseInt(base.slice(k, k + 2), 16) * 0.62 + 255 * 0.38));
  return `rgb(${mix.join(",")})`;
}

function draw() {
  byId("theme").textContent = dark() ? "light" : "dark";
  byId("theme").setAttribute("aria-label", `Change to ${byId("theme").textContent}`);
  byId("tilt").setAttribute("aria-pressed", String(state.tilted));
  byId("log").setAttribute("aria-pressed", String(!state.linear));
  byId("trouble").hidden = !missed;
  byId("trouble").textContent = missed;
  runs = state.rows.map((row, i) => ({ row, run: cache.get(row), style: styleOf(i), dash: DASHES[i] }));
  batch.update(new Map(runs.map((shown) => [shown.row, shown])));
  drawAxes();
  drawLegend();
  drawFacts();
  drawNumbers();
  drawRuns();
  remember();
}

function drawRuns() {
  if (!runs.length) return;
  byId("slider").value = now();
  byId("slider").setAttribute("aria-valuetext", `${short(state.time)} s`);
  byId("instant").textContent = `t = ${short(state.time)} s`;
  byId("instant").title = `snapshot ${now() + 1} of ${times.length}`;
  drawInstants();
  drawFlow();
  drawProfiles();
  drawSeries();
}

// What is there to be drawn, and between what numbers: the same at all times, so that they can be compared.
function drawAxes() {
  const [snapshots, samples] = ["time", "series_time"].map((name) => runs.some(({ run }) => run[name].length));
  for (const id of ["flow", "tilt", "profiles", "tails"]) byId(id).hidden = !snapshots;
  for (const id of ["over-time", "series", "more"]) byId(id).hidden = !samples;
  const absent = [snapshots ? "" : "snapshots", samples ? "" : "series"].filter(Boolean);
  byId("absent").hidden = !runs.length || !absent.length;
  byId("absent").textContent = `The result holds no ${absent.join(" and no ")}: time.snapshots and time.series in the run file say what is kept.`;
  for (const chart of [...charts.profiles, ...charts.series]) chart.axis = axisOf(chart.panel);
}

function axisOf(panel) {
  const share = panel.tails ? 0.005 : 0;
  const ranges = (above) => runs.map(({ run }) => run.range(panel.name, share, above)).filter(Boolean);
  const [low, high] = extent(ranges(false)).map((v) => v * panel.factor);
  if (panel.log && !state.linear) {
    const slowest = extent([runs.map(({ run }) => run.rest_speed / 3)])[0];
    const foot = panel.unit === "m/s" ? slowest : Math.max(extent(ranges(true))[0], 20 * coarsest(panel)); // below, steps show
    if (high > 3 * foot) return { up: [foot, 1.3 * high], log: true };
  }
  return { up: roomy([low, high], panel.span, panel.name === "h"), log: false };
}

function levelOf(panel) {
  return typeof panel.reference === "string" ? runs[0].run[panel.reference] : panel.reference;
}

// Which runs are shown at another time than the slider's: it is not one of theirs.
function drawInstants() {
  runs.forEach(({ run }, i) => {
    const at = run.time.length ? run.time[instantOf(run)] : state.time;
    const off = Math.abs(at - state.time) > 1e-6 * Math.max(times[times.length - 1], 1e-12);
    const last = run.time.length && at === run.time[run.time.length - 1] && at < state.time;
    const place = document.querySelectorAll("#legend .instant")[i];
    place.hidden = !off;
    place.textContent = `shown at t = ${short(at)} s${last ? ", its last snapshot" : ""}`;
  });
}

// The snapshot of a run that is nearest to the time; -1 where it has none.
function instantOf(run) {
  return run.time.length ? nearest(run.time, state.time) : -1;
}

function profile(run, name) {
  const instant = instantOf(run);
  return instant < 0 ? new Float64Array(run.x.length).fill(NaN) : run.at(name, instant);
}

// The cell of a run under the pointer, -1 where there is none.
function cellOf(run) {
  if (state.place === null || !run.x.length) return -1;
  const i = nearest(run.x, state.place);
  const edge = run.x[1] - run.x[0] || 1e-12;
  return state.place < run.x[0] - edge || state.place > run.x[run.x.length - 1] + edge ? -1 : i;
}

function values(place, texts, lead = "") {
  const spans = texts.map(([text, style]) => {
    const span = make("span", {}, text);
    span.style.color = style;
    span.style.color = `color-mix(in srgb, ${style} 65%, var(--text))`; // so that it can be read, where browsers know how
    return span;
  });
  place.replaceChildren(...(lead ? [make("span", { className: "quiet" }, lead)] : []), ...spans);
}

// The largest step of the runs shown: it says how many decimals are worth reading.
function coarsest(panel) {
  return Math.max(...runs.map(({ run }) => run.step(panel.name) * panel.factor), 1e-6 * panel.span);
}

function readings(panel) {
  if (runs.every(({ run }) => cellOf(run) < 0)) return [];
  return runs.map(({ run, style }) => {
    const i = cellOf(run);
    return [exact(i < 0 ? NaN : profile(run, panel.name)[i] * panel.factor, coarsest(panel)), style];
  });
}

function drawFlow() {
  const panel = head.profiles[0];
  if (byId("flow").hidden) return;
  const bumpy = runs.some(({ run }) => run.step("bed") > 0);
  const name = bumpy && !state.tilted ? [["bed ", ""], ["b", "i"], [", surface ", ""], ["b + h", "i"]] : panel.label;
  byId("flow-label").replaceChildren(label(name, panel.unit));
  const layers = runs.map(({ run, style, dash }) => ({ run, h: profile(run, "h"), style, dash }));
  const times_ = flow.show(layers, state.tilted, state.place, head.position, panel);
  const { factor, unit } = head.position;
  const cells = runs.map(({ run }) => [run, cellOf(run)]).filter(([, i]) => i >= 0);
  const lead = cells.length ? `x = ${short(cells[0][0].x[cells[0][1]] * factor)} ${unit}, h =` : "";
  values(byId("flow-values"), readings(panel), lead);
  const across = `Along the slope, x in ${unit}`;
  const grown = times_ > 1 ? `; lengths normal to it drawn ${times_} times as large` : "";
  byId("flow-hint").textContent = `${across}${state.tilted ? grown : ""}.`;
}

function drawProfiles() {
  if (byId("profiles").hidden) return;
  const { factor } = head.position;
  const across = extent(runs.map(({ run }) => [run.x[0] * factor, run.x[run.x.length - 1] * factor]));
  const xs = runs.map(({ run }) => run.x.map((v) => v * factor));
  for (const { panel, chart, axis, values: place } of charts.profiles) {
    const lines = runs.map(({ run, style, dash }, i) => ({
      x: xs[i],
      y: profile(run, panel.name).map((v) => v * panel.factor),
      style,
      dash,
    }));
    const cursor = state.place === null ? null : state.place * factor;
    chart.show({ across, ...axis, lines, cursor, level: levelOf(panel) });
    describe(chart, panel, `along the slope at t = ${short(state.time)} s`, lines);
    values(place, readings(panel));
  }
}

// What a chart shows, in words.
function describe(chart, panel, where, lines) {
  const ranges = lines.map(({ y }, i) => {
    const known = y.filter(Number.isFinite);
    const said = known.length ? extent([known]).map(short).join(" to ") : "nothing";
    return runs.length > 1 ? `${batch.name(runs[i].row)} ${said}` : said;
  });
  const name = panel.label.map(([text]) => text).join("");
  chart.sheet.canvas.setAttribute("aria-label", `${name} (${panel.unit}) ${where}: ${ranges.join(", ")}`);
}

function drawSeries() {
  if (byId("series").hidden) return;
  const across = extent(runs.map(({ run }) => run.series_time));
  const time = hovered === null ? state.time : hovered;
  for (const { panel, chart, axis, values: place } of charts.series) {
    const lines = runs.map(({ run, style, dash }) => ({ x: run.series_time, y: run.series[panel.name].map((v) => v * panel.factor), style, dash }));
    chart.show({ across, ...axis, lines, cursor: time, level: levelOf(panel) });
    describe(chart, panel, "over time", lines);
    const texts = runs.map(({ run, style }) => {
      const value = run.series_time.length ? run.series[panel.name][nearest(run.series_time, time)] : NaN;
      return [exact(value * panel.factor, coarsest(panel)), style];
    });
    values(place, texts);
  }
}

// ---- words

// The values of the swept keys of a run.
function keysOf(row) {
  const parts = [];
  for (const column of batch.columns.filter((c) => c.kind === "key")) {
    const symbol = column.label.filter(([, kind]) => kind);
    const unit = column.unit === "\u00b0" ? "\u00b0" : column.unit && ` ${column.unit}`;
    parts.push(parts.length ? ", " : "", label(symbol.length ? symbol : column.label), ` = ${column.word(row)}${unit}`);
  }
  return parts;
}

function outcomesOf(row) {
  const texts = batch.columns.filter((c) => c.kind === "outcome").map((column) => {
    const bound = column.name === "run_out" && batch.reserves.left_grid.has(row) ? "\u2265 " : "";
    const value = column.at[row];
    const name = column.label[0][0].trim();
    return Number.isNaN(value) ? `${name} \u2013` : `${name} ${bound}${column.word(row)} ${column.unit}`;
  });
  return texts.join(" \u00b7 ");
}

// A piece of a run's line.
function swatchOf(style, dash) {
  const svg = byId("swatch").content.cloneNode(true).firstElementChild;
  svg.firstElementChild.style.stroke = style;
  svg.firstElementChild.style.strokeDasharray = dash.join(" ");
  return svg;
}

function drawLegend() {
  const items = runs.map(({ row, style, dash }) => {
    const swatch = swatchOf(style, dash);
    const name = make("strong", {}, batch.rows.length > 1 ? batch.name(row) : "");
    const reserves = Object.entries(RESERVES).filter(([key]) => batch.reserves[key].has(row)).map(([, { sign, said }]) => `${sign} ${said}`);
    const status = table.status[row];
    const ended = ["ok", "at_rest"].includes(status) ? [] : [`\u00d7 ended early: ${table.failure[row] || status.replace("_", " ")}`];
    const lines = [
      make("div", {}, name, " ", ...keysOf(row)),
      make("div", { className: "quiet" }, outcomesOf(row)),
      make("div", { className: "reserve instant" }),
    ];
    for (const text of [...ended, ...reserves]) lines.push(make("div", { className: "reserve" }, text));
    const item = make("li", {}, swatch, make("div", {}, ...lines));
    if (runs.length > 1) {
      const remove = make("button", { type: "button", "aria-label": `Leave out ${batch.name(row)}` }, "\u00d7");
      remove.addEventListener("click", () => pick(row, true));
      item.append(remove);
    }
    return item;
  });
  byId("legend").replaceChildren(...items);
}

function drawFacts() {
  const parts = [head.files.filter(Boolean).join(", ")];
  if (head.rows < head.runs) parts.push(`the table has ${head.rows} of ${head.runs} runs, evenly spread`);
  if (head.shown < head.rows) parts.push(`profiles of ${head.shown} of ${head.rows} runs are in this page, evenly spread`);
  const strides = [...new Set(runs.filter(({ run }) => run.stride > 1).map(({ run }) => `every ${ordinal(run.stride)} of ${run.grid} cells, and those of front, rear, largest thickness and speed at each snapshot`))];
  parts.push(...strides);
  for (const { run, row } of runs) {
    for (const [what, share] of Object.entries(run.thinned)) if (share) parts.push(`${share} ${what} of ${batch.name(row)}`);
  }
  byId("facts").textContent = parts.filter(Boolean).join("; ");
}

function ordinal(n) {
  const tens = n % 100 > 10 && n % 100 < 14;
  return n === 2 ? "second" : `${n}${(!tens && { 1: "st", 2: "nd", 3: "rd" }[n % 10]) || "th"}`;
}

function drawNumbers() {
  const files = head.files.filter(Boolean).join(", ") || "the result";
  const place = document.querySelector("#numbers > div");
  byId("exact").textContent = `Numbers are stored in 16 bits here; the exact ones are in ${files}.`;
  const text = `Each profile and series of a run has a step of its own, and what is read here is the number of the file to half a step. All profiles but the thickness are shown only where the compacted thickness exceeds h_front. Made by warpgran ${head.version}.`;
  const top = make("tr", {}, make("th", { className: "left" }, "step"), ...runs.map(({ row }) => make("th", {}, batch.name(row))));
  const lines = [...head.profiles, ...head.series].map((panel) =>
    make("tr", {}, make("td", { className: "left" }, label(panel.label, panel.unit)), ...runs.map(({ run }) => make("td", {}, (run.step(panel.name) * panel.factor).toPrecision(2)))));
  place.replaceChildren(make("p", {}, text), make("table", {}, make("thead", {}, top), make("tbody", {}, ...lines)));
}

start().catch((error) => {
  byId("trouble").hidden = false;
  byId("trouble").textContent = `This page cannot be shown: ${error.message}. It needs Chrome or Edge 80, Firefox 113, Safari 16.4, or later.`;
  document.querySelector("main").replaceChildren(byId("trouble"));
  throw error;
});
