// SPDX-License-Identifier: BSD-3-Clause
// Access to the data of the page, embedded or in side files; series are decoded on demand.
"use strict";
window.stillpoint = {};
(function (page) {
  const NONE = 65535;
  const parse = (id) => JSON.parse(document.getElementById(id).textContent);

  page.index = parse("index");
  page.files = parse("files");

  // {low, step, data} -> numbers, null where there is none.
  page.unpack = function (packed) {
    const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
    const numbers = new Array(bytes.length / 2);
    for (let i = 0; i < numbers.length; ++i) {
      const number = bytes[2 * i] | (bytes[2 * i + 1] << 8);
      numbers[i] = number === NONE ? null : packed.low + packed.step * number;
    }
    return numbers;
  };

  // Index of the nearest number; -1 in an empty list.
  page.nearest = function (list, value) {
    let best = -1, distance = Infinity;
    list.forEach((item, i) => { const d = Math.abs(item - value); if (d < distance) { distance = d; best = i; } });
    return best;
  };

  // --- data of runs in side files, of a page that is served ---
  // {series, images, truth} by run, still packed.
  const loaded = new Map(), loading = new Map(), wanted = new Map();
  const has = (run) => loaded.has(run) || document.getElementById("series-" + run) !== null;

  async function request(run) {
    const response = await fetch("runs/" + page.index.runs[run].key + ".json");
    if (!response.ok) throw new Error(response.status + " " + response.statusText);
    loaded.set(run, await response.json());
  }

  function load(run) {
    if (!loading.has(run)) loading.set(run, request(run).finally(() => loading.delete(run)));
    return loading.get(run);
  }

  // Calls `action` when the data of the runs is there: at once, or after loading it. Of several calls for a section only
  // the last one counts.
  page.withRuns = async function (section, runs, action) {
    const lacking = runs.filter((run) => !has(run)), place = document.getElementById(section), call = {};
    wanted.set(section, call);
    let problem = "";
    if (lacking.length) {
      place.setAttribute("aria-busy", "true");
      await Promise.all(lacking.map(load)).catch((error) => { problem = "The data of a run cannot be loaded (" + error.message + "). Is the server running? Reload the page to select it again."; });
      if (wanted.get(section) !== call) return;
      place.removeAttribute("aria-busy");
    }
    document.getElementById("load-problem").textContent = problem;
    if (!problem) action();
  };

  // Series of a run: {start, frames, t, numbers, worst, loops, faults, landmarks, surfaces, columns: {name: numbers}}; a few are cached.
  // `numbers`: frame numbers if the page contains a part of the frames only, else null.
  // A fault: {begin, end: times; text}. Landmarks: {x, y, z, static: number of those at the beginning that are}, or null.
  // Surfaces: {x, y, z, color: 1024 red + 32 green + blue, each 0 to 31}, or null.
  // A loop: {query, match: frames or -1; at, back: times; inliers, residual, reason: empty if it is accepted}.
  const cache = new Map();
  page.series = function (run) {
    if (!cache.has(run)) {
      if (cache.size > 24) cache.clear();
      const packed = loaded.has(run) ? loaded.get(run).series : parse("series-" + run);
      const columns = {};
      for (const [name, column] of Object.entries(packed.columns)) columns[name] = page.unpack(column);
      const t = page.unpack(packed.t);
      const loops = packed.loops.map(([at, back, inliers, residual, reason]) =>
        ({ at, back, inliers, residual, reason, query: page.nearest(t, at), match: page.nearest(t, back) }));
      const faults = packed.faults.map(([begin, end, text]) => ({ begin, end, text }));
      const numbers = packed.numbers ? page.unpack(packed.numbers).map(Math.round) : null;
      const points = packed.landmarks, landmarks = points ? { x: page.unpack(points.x), y: page.unpack(points.y), z: page.unpack(points.z), static: points.static } : null;
      const cloud = packed.surfaces, surfaces = cloud ? { x: page.unpack(cloud.x), y: page.unpack(cloud.y), z: page.unpack(cloud.z), color: page.unpack(cloud.color).map(Math.round) } : null;
      cache.set(run, { start: packed.start, frames: packed.frames, t, numbers, worst: packed.worst, loops, faults, landmarks, surfaces, columns });
    }
    return cache.get(run);
  };

  page.frameNumber = (series, frame) => (series.numbers ? series.numbers[frame] : frame);

  // {frame: JPEG in base64} of a run.
  const images = new Map();
  page.images = function (run) {
    if (loaded.has(run)) return loaded.get(run).images;
    if (!images.has(run)) images.set(run, document.getElementById("images-" + run) ? parse("images-" + run) : {});
    return images.get(run);
  };

  // Ground truth of a run, with times relative to its first frame; null without one.
  page.truth = function (run, start) {
    const packed = loaded.has(run) ? loaded.get(run).truth : page.index.truths[page.index.runs[run].truth];
    if (!packed) return null;
    return {
      t: page.unpack(packed.t).map((t) => t + packed.start - start),
      x: page.unpack(packed.x), y: page.unpack(packed.y), z: page.unpack(packed.z),
    };
  };

  // The range {min, max} of an axis, scaled by `factor` around `at` (null: its center) and limited to `whole`.
  page.zoomed = function ({ min, max }, factor, at, [low, high]) {
    const center = at !== null && min <= at && at <= max ? at : (min + max) / 2;
    return [Math.max(low, center - factor * (center - min)), Math.min(high, center + factor * (max - center))];
  };

  page.LINE_COLORS = 6; // --c0 ... of page.css
  page.color = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  page.element = function (tag, attributes, text) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes || {})) element.setAttribute(name, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };
})(window.stillpoint);
