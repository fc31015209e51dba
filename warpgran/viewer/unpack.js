"use strict";
// The data of the page: gzipped pieces in base64, each a line of JSON and 16-bit codes.

const MISSING = 65535;

async function unpack(id) {
  const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(stream).arrayBuffer();
  const end = new Uint8Array(buffer).indexOf(10);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 0, end)));
  const arrays = {};
  let place = end + 1;
  for (const [name, { shape, offset, step }] of Object.entries(head.arrays)) {
    const codes = new Uint16Array(buffer, place, shape.reduce((a, b) => a * b, 1));
    arrays[name] = Float64Array.from(codes, (code) => (code === MISSING ? NaN : offset + step * code));
    place += codes.byteLength;
  }
  return { head, arrays };
}

// A run as it is drawn: positions and times, profiles by snapshot, series.
async function unpackRun(row) {
  const { head, arrays } = await unpack(`run-${row}`);
  const [first, last] = head.x;
  const spacing = head.cells > 1 ? (last - first) / (head.cells - 1) : 0;
  const x = Float64Array.from({ length: head.cells }, (_, i) => first + spacing * i);
  const step = (name) => head.arrays[name].step;
  const at = (name, instant) => arrays[name].subarray(instant * head.cells, (instant + 1) * head.cells);
  const envelope = new Float64Array(head.cells); // the largest thickness in each cell
  arrays.h.forEach((h, i) => {
    if (h > envelope[i % head.cells]) envelope[i % head.cells] = h;
  });
  return { ...head, envelope, x, spacing, arrays, step, at };
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
