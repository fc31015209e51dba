"use strict";
// The data of the page: gzipped pieces in base64, each a line of JSON and 16-bit codes.

const MISSING = 65535;

// Numbers as they are stored, in two bytes each; they are decoded where they are read.
class Numbers {
  constructor(codes, { offset, step }) {
    Object.assign(this, { codes, offset, step });
  }

  value(code) {
    return code === MISSING ? NaN : this.offset + this.step * code;
  }

  part(from, to) {
    return Float64Array.from(this.codes.subarray(from, to), (code) => this.value(code));
  }

  all() {
    return this.part(0, this.codes.length);
  }

  // Between these all numbers lie but a share at each end; null where there is none. From the least above zero if asked.
  range(share = 0, above = false) {
    const counts = new Uint32Array(MISSING + 1);
    for (const code of this.codes) counts[code] += 1;
    counts[MISSING] = 0;
    if (above) for (let code = 0; code < MISSING && !(this.value(code) > 0); code += 1) counts[code] = 0;
    const all = counts.reduce((a, b) => a + b, 0);
    const end = (codes) => {
      let left = share * all;
      for (const code of codes) {
        left -= counts[code];
        if (left < 0) return this.value(code);
      }
      return NaN;
    };
    const codes = Array.from({ length: MISSING }, (_, code) => code);
    return all ? [end(codes), end(codes.reverse())] : null;
  }
}

async function unpack(id) {
  const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(stream).arrayBuffer();
  const end = new Uint8Array(buffer).indexOf(10);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 0, end)));
  const arrays = {};
  let place = end + 1;
  for (const [name, about] of Object.entries(head.arrays)) {
    const codes = new Uint16Array(buffer, place, about.shape.reduce((a, b) => a * b, 1));
    arrays[name] = new Numbers(codes, about);
    place += codes.byteLength;
  }
  return { head, arrays };
}

// A run as it is drawn: positions and times, profiles by snapshot, series of these names.
async function unpackRun(row, names) {
  const { head, arrays } = await unpack(`run-${row}`);
  const { cells } = head;
  const ranges = new Map();
  return {
    ...head,
    x: positions(head.x, arrays.gap ? arrays.gap.all() : new Float64Array(cells - 1).fill(1)),
    bed: arrays.bed.all(),
    envelope: envelope(arrays.h, cells),
    step: (name) => arrays[name].step,
    at: (name, instant) => arrays[name].part(instant * cells, (instant + 1) * cells),
    series: Object.fromEntries(names.map((name) => [name, arrays[name].all()])),
    range: (name, share, above) => {
      const key = `${name} ${share} ${above}`;
      if (!ranges.has(key)) ranges.set(key, arrays[name].range(share, above));
      return ranges.get(key);
    },
  };
}

// Positions of cells, given the first and the last, and how many cells of the grid lie between neighbours.
function positions([first, last], gaps) {
  const places = [0];
  for (const gap of gaps) places.push(places[places.length - 1] + Math.round(gap));
  const all = places[places.length - 1] || 1;
  return Float64Array.from(places, (place) => first + ((last - first) * place) / all);
}

// The largest thickness in each cell.
function envelope(h, cells) {
  const most = new Uint16Array(cells);
  h.codes.forEach((code, i) => {
    if (code !== MISSING && code > most[i % cells]) most[i % cells] = code;
  });
  return Float64Array.from(most, (code) => Math.max(0, h.value(code)));
}

// The place in an ascending list that lies nearest.
function nearest(list, value) {
  let low = 0;
  let high = list.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] < value) low = middle;
    else high = middle;
  }
  return Math.abs(list[low] - value) <= Math.abs(list[high] - value) ? low : high;
}

// Smallest and largest number of some lists, NaN left out.
function extent(lists) {
  let low = Infinity;
  let high = -Infinity;
  for (const list of lists) {
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 1];
}
