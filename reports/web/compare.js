// SPDX-License-Identifier: BSD-3-Clause
// Several runs in one view: paths, errors, status, module times, numbers, configs, and frames at one time.
"use strict";
(function (page) {
  const byId = (id) => document.getElementById(id);
  const MAX_RUNS = 8, BINS = 800;
  const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3]];
  const state = { runs: [], time: 0, end: 0, plot: null, moving: false, paths: [], scene: null, shows: new Set() };

  const dash = (i) => DASHES[i % DASHES.length];
  const color = (i) => page.color("c" + (i % page.LINE_COLORS));
  const series = (i) => page.series(state.runs[i]);
  const info = (i) => page.index.runs[state.runs[i]];
  const frameAt = (i, time) => page.nearest(series(i).t, time);
  const text = (value) => (value === null || value === undefined ? "-" : Number(value.toPrecision(4)).toString());

  // Names without what all runs share.
  function names() {
    const all = state.runs.map((_, i) => info(i));
    const parts = [(run) => run.label, (run) => run.sequence, (run) => "seed " + run.seed, (run) => "repetition " + run.repetition, (run) => run.kind,
      (run) => (run.sweep ? run.sweep.axis + " = " + run.sweep.value : ""), (run) => run.build.slice(0, 10)];
    const apart = parts.filter((part) => new Set(all.map(part)).size > 1);
    return all.map((run) => (apart.length ? apart : [page.runName]).map((part) => part(run)).filter((one) => one).join(", "));
  }

  function swatch(i) {
    const mark = page.element("span", { class: "swatch", "aria-hidden": "true" });
    mark.style.borderTop = `3px ${["solid", "dashed", "dotted", "double"][i % 4]} ${color(i)}`;
    return mark;
  }

  function listRuns(own) {
    byId("compared").replaceChildren(...state.runs.map((run, i) => {
      const item = page.element("li"), remove = page.element("button", { type: "button", "aria-label": "Remove " + own[i] }, "×");
      remove.addEventListener("click", () => page.compareRuns(state.runs.filter((one) => one !== run)));
      item.append(swatch(i), page.element("a", { href: "#run=" + info(i).key, title: "Frame by frame: " + page.runName(info(i)) }, own[i]),
        info(i).outcome === "ok" ? "" : " (" + info(i).outcome + ")", " ", remove);
      return item;
    }));
    const shared = new Set(state.runs.map((_, i) => info(i).truth));
    byId("compare-note").textContent = shared.size > 1 ? "These runs are of different sequences or data: compare shapes, not times and places." : "";
  }

  // --- paths ---
  // Paths of the runs, and first the ground truths; those of the runs are in their order.
  function comparedPaths() {
    const runs = [], truths = new Map();
    state.runs.forEach((run, i) => {
      const own = series(i), { x, y, z, qx, qy, qz, error_m: error } = own.columns, truth = page.truth(run, own.start);
      if (truth) truths.set(info(i).truth, { ...truth, color: page.color("ink"), dash: [6, 5], width: 1.2 });
      if (x) runs.push({ x, y, z, t: own.t, q: { x: qx, y: qy, z: qz }, error, loops: own.loops, landmarks: own.landmarks, surfaces: own.surfaces, color: color(i), dash: dash(i), width: 1.8 });
    });
    return [...truths.values(), ...runs];
  }

  const frameOf = (path) => (path.q ? page.nearest(path.t, state.time) : undefined);

  function drawPlan() {
    if (state.paths.length) page.drawPaths(byId("compare-path"), state.paths.map((path) => ({ ...path, at: frameOf(path) })));
  }

  function drawScene() {
    const eye = (page.stateOf("eye") || "").split(" ").map(Number), { scene, shows } = state;
    const largest = scene.show(state.paths, shows, eye.length === 6 && eye.every(Number.isFinite) ? eye : null);
    byId("path-caption").textContent = `3-D, z up; squares of ${text(scene.cell)} m; dashed: ground truth; ball: position at the time`
      + (shows.has("error") ? `; violet to yellow: error 0 to ${text(largest)} m` : "") + (shows.has("loops") && state.paths.some((path) => path.loops && path.loops.length) ? "; loops: solid accepted, dashed refused" : "")
      + (shows.has("landmarks") && state.paths.some((path) => path.landmarks) ? "; points: features, gray static, red dynamic" : "")
      + (shows.has("surfaces") && state.paths.some((path) => path.surfaces) ? "; small points: static surfaces by the depth images, in their colors" : "")
      + ". Drag to turn, with the right button to move, wheel to zoom, click a path to select its time. Keys: arrows turn, with shift move, + and - zoom, 0 resets.";
  }

  function pointPaths() {
    if (state.scene && state.shows.has("3d")) state.scene.point(state.paths.map(frameOf));
    else drawPlan();
  }

  // Shows the chosen view; the top view until the library of the other one is there, or if the browser cannot show it.
  function showPaths() {
    const wants = state.shows.has("3d"), has = Boolean(wants && state.scene);
    byId("compare-view").value = wants ? "3d" : "plan";
    byId("scene-options").hidden = byId("compare-scene").hidden = !has;
    byId("compare-path").hidden = has;
    byId("compare-paths").hidden = !state.paths.length;
    for (const box of byId("scene-options").querySelectorAll("input")) {
      box.checked = state.shows.has(box.value);
      box.parentElement.hidden = !state.paths.some((path) => ({ error: path.error, cameras: path.q, loops: path.loops && path.loops.length, landmarks: path.landmarks, surfaces: path.surfaces })[box.value]);
    }
    if (has) drawScene(); else byId("path-caption").textContent = "Top view: x to the right, y up [m]; dashed: ground truth; dot: position at the time";
    pointPaths();
    if (!wants || has) return;
    page.pathScene(byId("compare-scene"), (time) => setTime(time, false), (eye) => page.setState({ eye: eye.map((value) => value.toFixed(2)).join(" ") }))
      .then((scene) => { state.scene = state.scene || scene; }, (error) => { byId("scene-problem").textContent = error.message; state.shows.delete("3d"); })
      .then(showPaths);
  }

  // What the address names of `view`: "3d" and what is drawn besides the paths.
  function chooseView(shows) {
    state.shows = shows;
    page.setState({ view: shows.has("3d") ? [...shows].join(" ") : null, ...(shows.has("3d") ? {} : { eye: null }) });
    showPaths();
  }

  // --- error over time ---
  // Largest error of a run in each of BINS intervals of time; all values if there are fewer. A frame without an error
  // is a gap; intervals between frames have the error of the frame before.
  function binned(own, times) {
    const values = new Array(times.length).fill(undefined), step = times[1] - times[0];
    own.t.forEach((t, i) => {
      const at = Math.min(Math.round(t / step), times.length - 1), value = own.columns.error_m[i];
      if (values[at] === undefined || values[at] === null || value > values[at]) values[at] = value;
    });
    const last = Math.round(own.t[own.frames - 1] / step);
    values.forEach((value, at) => { if (value === undefined) values[at] = at > 0 && at <= last ? values[at - 1] : null; });
    return values;
  }

  function drawErrors(own) {
    const place = byId("compare-error");
    if (state.plot) state.plot.destroy();
    state.plot = null;
    place.replaceChildren();
    const drawn = state.runs.map((_, i) => i).filter((i) => series(i).columns.error_m);
    place.hidden = !drawn.length || !(state.end > 0);
    if (place.hidden) return;
    const most = Math.max(...drawn.map((i) => series(i).frames)), count = Math.min(BINS, most);
    const times = Array.from({ length: count }, (_, i) => (i * state.end) / (count - 1 || 1));
    place.append(page.element("figcaption", {}, "Position error after alignment (ATE)" + (most > BINS ? "; largest of each " + (state.end / BINS).toFixed(2) + " s" : "")));
    const lines = drawn.map((i) => page.line(own[i] + " [m]", "c" + (i % page.LINE_COLORS), { dash: dash(i) }));
    state.plot = page.plot({
      width: place.clientWidth || 900, height: 200, cursor: { drag: { x: true, y: false } }, scales: { x: { time: false } }, axes: page.axes("m"),
      series: [{ label: "time [s]", value: page.number }, ...lines],
      hooks: { setCursor: [(u) => { if (u.cursor.left >= 0 && u.cursor.idx !== null) setTime(times[u.cursor.idx], true); }], ready: [pointAt] },
    }, [times, ...drawn.map((i) => binned(series(i), times))], place);
  }

  const pointAt = (plot) => plot.setCursor({ left: plot.valToPos(state.time, "x"), top: plot.over.clientHeight / 2 }, false);

  // --- status and faults ---
  function drawStatus(own) {
    byId("compare-status").replaceChildren(...state.runs.map((_, i) => {
      const row = page.element("div", { class: "status-row" }), bar = page.element("div", { class: "bar" }), one = series(i);
      const part = (begin, end, className, title) => {
        const box = page.element("span", { class: className, title });
        box.style.left = (100 * begin) / state.end + "%";
        box.style.width = (100 * (end - begin)) / state.end + "%";
        bar.append(box);
      };
      let start = 0;
      for (let frame = 1; frame <= one.frames; ++frame) {
        if (frame < one.frames && page.statusAt(one, frame) === page.statusAt(one, start)) continue;
        const end = one.t[Math.min(frame, one.frames - 1)], name = page.statusAt(one, start);
        part(one.t[start], end, "status " + name.replaceAll(" ", "-"), `${name}, ${one.t[start].toFixed(2)} to ${end.toFixed(2)} s`);
        start = frame;
      }
      for (const { begin, end, text: fault } of one.faults) part(begin, Math.min(end, state.end), "fault", `fault ${fault}, ${begin.toFixed(2)} to ${end.toFixed(2)} s`);
      const label = page.element("span", { class: "name" });
      label.append(swatch(i), own[i]);
      row.append(label, bar);
      return row;
    }));
    const used = new Set(state.runs.flatMap((_, i) => series(i).t.map((__, frame) => page.statusAt(series(i), frame))));
    const key = (name, title) => { const one = page.element("span", { class: "key" }); one.append(page.element("span", { class: "status " + name }), " " + title); return one; };
    byId("status-key").replaceChildren(...[...used].map((name) => key(name.replaceAll(" ", "-"), name)),
      ...(state.runs.some((_, i) => series(i).faults.length) ? [key("fault", "fault injected")] : []));
  }

  // --- tables ---
  // Rows [name, title, values per run]; the best is not marked: one run is no result.
  function table(place, rows, own, none) {
    byId(place).closest("details").hidden = false;
    if (!rows.length) { byId(place).replaceChildren(page.element("p", { class: "none" }, none)); return; }
    const head = page.element("tr"), body = page.element("table", { class: "stacked" });
    head.append(page.element("th", { scope: "col" }, ""), ...own.map((name) => page.element("th", { scope: "col" }, name)));
    body.createTHead().append(head);
    const lines = body.createTBody();
    for (const [name, title, values] of rows) {
      const row = page.element("tr");
      row.append(page.element("th", { scope: "row", title }, name), ...values.map((value, i) => page.element("td", { "data-label": own[i] })));
      values.forEach((value, i) => row.cells[i + 1].append(value));
      lines.append(row);
    }
    byId(place).replaceChildren(body);
  }

  function metricRows() {
    const all = state.runs.map((_, i) => new Map(info(i).metrics.map(([name, value, unit]) => [name, { value, unit }])));
    const known = [...new Set(all.flatMap((metrics) => [...metrics.keys()]))];
    return known.map((name) => {
      const { unit } = all.find((metrics) => metrics.has(name)).get(name);
      return [name + (unit ? " [" + unit + "]" : ""), page.index.tooltips[name] || "", all.map((metrics) => (metrics.has(name) && metrics.get(name).value !== null ? text(metrics.get(name).value) : page.missing("the run has no value of this metric")))];
    });
  }

  const finite = (values) => values.filter((value) => value !== null).sort((a, b) => a - b);

  function moduleRows() {
    const modules = [...new Set(state.runs.flatMap((_, i) => Object.keys(series(i).columns).filter((name) => name.startsWith("ms:"))))];
    return modules.map((name) => [name.slice(3) + " [ms]", "Median time per frame in which the module ran", state.runs.map((_, i) => {
      const values = finite(series(i).columns[name] || []);
      return values.length ? text(values[Math.floor((values.length - 1) / 2)]) : page.missing("the module was not executed in this run");
    })]);
  }

  function flat(value, name, into) {
    if (value !== null && typeof value === "object" && !Array.isArray(value)) for (const [key, one] of Object.entries(value)) flat(one, name ? name + "." + key : key, into);
    else into.set(name, typeof value === "string" ? value : JSON.stringify(value));
    return into;
  }

  // What differs between the manifests of the runs: config, data, build and machine.
  function manifestRows() {
    const all = state.runs.map((_, i) => flat(page.index.manifests[info(i).manifest] || {}, "", new Map()));
    const known = [...new Set(all.flatMap((values) => [...values.keys()]))];
    return known.filter((name) => new Set(all.map((values) => values.get(name))).size > 1)
      .map((name) => [name.replace(/^config\.resolved\./, "config: "), "", all.map((values) => (values.has(name) ? values.get(name) : "not set"))]);
  }

  // --- frames ---
  function showFrames(own) {
    byId("compare-frames").replaceChildren(...state.runs.map((run, i) => {
      const figure = page.element("figure"), images = page.images(run), frames = Object.keys(images).map(Number), one = series(i);
      if (!frames.length || !one.frames) { figure.hidden = true; return figure; }
      const frame = frames.reduce((best, other) => (Math.abs(one.t[other] - state.time) < Math.abs(one.t[best] - state.time) ? other : best));
      const caption = page.element("figcaption");
      caption.append(swatch(i), `${own[i]}: frame ${page.frameNumber(one, frame)} at ${one.t[frame].toFixed(2)} s`
        + (Math.abs(one.t[frame] - state.time) > 0.1 ? ", the nearest with an image" : ""));
      figure.append(page.element("img", { src: "data:image/jpeg;base64," + images[frame], alt: "Annotated image of frame " + page.frameNumber(one, frame) + " of " + own[i] }), caption);
      return figure;
    }));
  }

  function readout(own) {
    byId("compare-readout").replaceChildren(...state.runs.filter((_, i) => series(i).frames).map((run) => {
      const i = state.runs.indexOf(run), one = series(i), frame = frameAt(i, state.time), part = page.element("span");
      const error = one.columns.error_m ? one.columns.error_m[frame] : null;
      const beyond = one.t[one.frames - 1] < state.time - 0.5;
      part.append(swatch(i), page.element("b", {}, own[i]), " ", page.element("span", {}, beyond ? "ended" : (error === null ? "no error" : "error " + text(error) + " m") + ", " + page.statusAt(one, frame)));
      return part;
    }));
  }

  function setTime(time, fromChart) {
    if (state.moving || !state.runs.length) return;
    state.moving = true;
    state.time = Math.max(0, Math.min(state.end, time));
    byId("compare-time").value = state.time;
    byId("compare-at").textContent = state.time.toFixed(2) + " s";
    const own = names();
    readout(own);
    pointPaths();
    showFrames(own);
    if (!fromChart && state.plot) pointAt(state.plot);
    for (const bar of byId("compare-status").querySelectorAll(".bar")) bar.style.setProperty("--at", (100 * state.time) / (state.end || 1) + "%");
    page.setState({ t: state.time.toFixed(2) });
    state.moving = false;
  }

  function draw() {
    const none = state.runs.length === 0, own = names();
    byId("compare-views").hidden = none;
    byId("compare-none").hidden = !none;
    byId("compare").dataset.runs = state.runs.map((_, i) => info(i).key).join(".");
    listRuns(own);
    if (none) return;
    state.end = Math.max(...state.runs.map((_, i) => series(i).t[series(i).frames - 1] || 0));
    byId("compare-time").max = state.end;
    byId("compare-time").step = Math.max(state.end / 1000, 0.01);
    state.paths = comparedPaths();
    showPaths();
    drawErrors(own);
    drawStatus(own);
    table("compare-metrics", metricRows(), own, "The runs have no metrics.");
    table("compare-modules", moduleRows(), own, "The runs have no module times.");
    if (!moduleRows().length) byId("compare-modules").closest("details").hidden = true;
    const differences = manifestRows();
    byId("compare-differences").textContent = `Differences of config, data, build and machine: ${differences.length}`;
    table("compare-config", differences, own, state.runs.length > 1 ? "Config, data, build and machine are equal." : "Select a second run to see what differs.");
    setTime(state.time, true); // the new chart points at it when it is ready
  }

  // Shows runs, by index; more than MAX_RUNS are not drawn.
  page.compareRuns = function (runs, source) {
    const distinct = [...new Set(runs)], shown = distinct.slice(0, MAX_RUNS);
    page.withRuns("compare", shown, () => {
      state.runs = shown;
      byId("compare-source").textContent = (source || "") + (distinct.length > MAX_RUNS ? ` The first ${MAX_RUNS} of ${distinct.length} runs are shown.` : "");
      page.setState({ compare: state.runs.map((_, i) => info(i).key).join(".") }, true);
      draw();
    });
  };
  page.comparedRuns = () => state.runs;
  page.redrawCompare = draw;

  page.startCompare = function () {
    const list = byId("compare-add");
    page.index.runs.forEach((run, i) => list.append(page.element("option", { value: i }, page.runName(run))));
    list.addEventListener("change", () => { if (list.value !== "") page.compareRuns([...state.runs, Number(list.value)]); list.value = ""; });
    byId("compare-clear").addEventListener("click", () => page.compareRuns([]));
    byId("compare-time").addEventListener("input", () => setTime(Number(byId("compare-time").value), false));
    window.addEventListener("resize", () => { if (state.plot) state.plot.setSize({ width: byId("compare-error").clientWidth, height: 200 }); pointPaths(); });
    byId("compare-view").addEventListener("change", (event) => chooseView(new Set(event.target.value === "3d" ? ["3d", "cameras", "loops", "landmarks", "surfaces", ...(state.runs.length === 1 ? ["error"] : [])] : [])));
    byId("scene-options").addEventListener("change", ({ target }) => { if (target.checked) state.shows.add(target.value); else state.shows.delete(target.value); chooseView(state.shows); });
    page.onState(() => {
      const keys = (page.stateOf("compare") || "").split(".");
      const runs = keys.map((key) => page.index.runs.findIndex((run) => run.key === key)).filter((i) => i >= 0).slice(0, MAX_RUNS);
      const time = Number(page.stateOf("t")) || 0;
      state.shows = new Set((page.stateOf("view") || "").split(" ").filter((name) => name));
      page.withRuns("compare", runs, () => { state.runs = runs; state.time = time; draw(); });
    });
  };
})(window.stillpoint);
