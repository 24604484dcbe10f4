// SPDX-License-Identifier: BSD-3-Clause
// Explorer of a single run: paths, charts, metrics, manifest, and the selected frame.
"use strict";
(function (page) {
  const byId = (id) => document.getElementById(id);
  const state = { run: -1, frame: null, worstAt: -1, charts: null, views: null, inspector: null };

  const name = page.runName = (run) => run.label + " on " + run.sequence + ", seed " + run.seed + (run.repetition > 1 ? ", repetition " + run.repetition : "")
    + (run.sweep ? ", " + run.sweep.axis + " = " + run.sweep.value : "") + (run.outcome === "ok" ? "" : " (" + run.outcome + ")");

  function readout(series, frame) {
    const place = byId("readout");
    place.replaceChildren();
    if (!series.frames) return;
    const add = (label, text) => { const part = page.element("span", { title: label }); part.append(page.element("b", {}, label), " ", page.element("span", {}, text)); place.append(part); };
    add("frame", String(page.frameNumber(series, frame)));
    add("time", series.t[frame].toFixed(3) + " s");
    add("status", page.statusAt(series, frame));
    for (const fault of series.faults) if (fault.begin <= series.t[frame] && series.t[frame] < fault.end) add("fault", fault.text);
    const shown = { error_m: "error [m]", three_sigma_m: "3 sigma, claimed [m]", three_sigma_deg: "3 sigma, claimed [deg]", frame_to_frame_error_m: "frame-to-frame error [m]", error_deg: "error [deg]", features: "features", landmarks: "landmarks in the window", dynamic: "dynamic fraction" };
    for (const [column, values] of Object.entries(series.columns)) {
      const label = column.startsWith("ms:") ? column.slice(3) + " [ms]" : shown[column];
      if (label) add(label, values[frame] === null ? "-" : Number(values[frame].toPrecision(4)).toString());
    }
  }

  // Selects a frame in all views; the chart cursors are left alone if the pointer is in a chart.
  function point(frame, fromChart) {
    if (state.moving || state.run < 0) return;
    state.moving = true;
    state.frame = frame;
    readout(page.series(state.run), frame);
    state.views.point(frame);
    state.inspector.show(frame);
    if (!fromChart) state.charts.point(frame);
    byId("runs").dataset.frame = frame;
    page.setState({ run: page.index.runs[state.run].key, frame });
    state.moving = false;
  }

  function headed(titles) {
    const table = page.element("table"), head = page.element("tr");
    for (const title of titles) head.append(page.element("th", { scope: "col" }, title));
    table.createTHead().append(head);
    table.createTBody();
    return table;
  }

  function showMetrics(run) {
    const table = headed(["metric", "value", "unit", "protocol"]);
    for (const [metric, value, unit, protocol] of run.metrics) {
      const row = page.element("tr");
      row.append(page.element("th", { scope: "row", title: page.index.tooltips[metric] || "" }, metric), page.element("td", {}, value === null ? "not finite" : Number(value.toPrecision(6)).toString()),
        page.element("td", {}, unit), page.element("td", {}, protocol));
      table.tBodies[0].append(row);
    }
    byId("metrics").replaceChildren(table);
    page.stackTables(byId("metrics").parentElement);
  }

  // Lists the recognized places of the run; a click selects the frame.
  function showLoops(series) {
    const table = headed(["time [s]", "earlier visit [s]", "inliers", "residual [px]", "result"]);
    for (const loop of series.loops) {
      const row = page.element("tr"), select = page.element("td"), button = page.element("button", { type: "button" }, loop.at.toFixed(2));
      button.addEventListener("click", () => { if (loop.query >= 0) point(loop.query, false); });
      select.append(button);
      row.append(select);
      for (const text of [loop.back.toFixed(2), loop.inliers, loop.residual.toFixed(2), loop.reason === "" ? "accepted" : "refused: " + loop.reason.replaceAll("_", " ")])
        row.append(page.element("td", {}, text));
      table.tBodies[0].append(row);
    }
    byId("loops").replaceChildren(table);
    byId("loops").closest("details").hidden = series.loops.length === 0;
  }

  // Command that repeats this run with its seeds and repetitions; empty for runs without a plan.
  function command(run) {
    const plan = JSON.parse(byId("plans").textContent).find((candidate) => candidate.runs.includes(run.key));
    if (!plan) return "";
    const quoted = (text) => "'" + text.replaceAll("'", "'\\''") + "'", own = " (" + plan.name + ")";
    const bare = (text) => (text.endsWith(own) ? text.slice(0, -own.length) : text);
    return "stillpoint bench " + quoted(plan.argument) + " --filter " + quoted(bare(run.label)) + " --filter " + quoted(bare(run.sequence)) + " --store repeated.sqlite";
  }

  function show(index) {
    state.run = index;
    const run = page.index.runs[index], series = page.series(index);
    state.frame = null;
    state.worstAt = -1;
    byId("run").value = state.run;
    const outcome = run.outcome === "ok" ? (series.frames ? "" : "The store has no frames of this run.") : run.outcome + ": " + run.detail;
    const part = series.numbers ? `The page contains ${series.frames} of the ${run.frames} frames of this run: equal steps, all changes of the status, and the worst.` : "";
    byId("outcome").textContent = [outcome, part, ...run.notes].filter((text) => text).join(" ");
    showMetrics(run);
    showLoops(series);
    byId("repeat-run").textContent = command(run);
    byId("manifest").textContent = JSON.stringify(page.index.manifests[run.manifest] || null, null, 2);
    state.charts = page.drawCharts(byId("series"), series, (frame) => point(frame, true), (min, max) => {
      state.views.zoom(min, max);
      byId("runs").dataset.zoom = min.toFixed(3) + " " + max.toFixed(3);
      const all = min <= series.t[0] && max >= series.t[series.frames - 1];
      page.setState({ zoom: all ? null : min.toFixed(3) + " " + max.toFixed(3) });
    });
    state.views.show(series, page.truth(state.run, series.start));
    readout(series, 0);
    state.inspector.select(state.run, series);
    byId("time-histograms").hidden = page.drawHistograms(byId("histograms"), series) === 0;
    byId("runs").dataset.run = run.key;
  }

  // Shows a run once its data is there; `then` is called after that.
  page.selectRun = function (index, then) {
    const count = page.index.runs.length, run = (index + count) % count;
    page.withRuns("runs", [run], () => { show(run); if (then) then(); });
  };

  function step(frames) {
    if (state.run < 0) return;
    const series = page.series(state.run);
    if (series.frames) point(Math.max(0, Math.min(series.frames - 1, (state.frame === null ? -1 : state.frame) + frames)), false);
  }

  function stepWorst(steps) {
    if (state.run < 0) return;
    const worst = page.series(state.run).worst;
    if (!worst.length) return;
    state.worstAt = (Math.max(state.worstAt, steps > 0 ? -1 : 0) + steps + worst.length) % worst.length;
    point(worst[state.worstAt], false);
  }

  // Compares the runs of a number in a table, added to the selected ones with ctrl, shift or meta.
  function compareSources(link, adds) {
    const keys = link.dataset.runs.split(" "), runs = keys.map((key) => indexOf(key)).filter((run) => run >= 0);
    const source = "Source of " + link.textContent + ": " + (keys.length === 1 ? "one run" : "median of the successful ones of " + keys.length + " runs") + ". Protocol: " + link.closest("td").title;
    page.compareRuns(adds ? [...page.comparedRuns(), ...runs] : runs, source);
    openRun(runs[0]);
    byId("compare").scrollIntoView();
  }

  const indexOf = (key) => page.index.runs.findIndex((run) => run.key === key);

  function openRun(run) {
    page.selectRun(run, () => page.setState({ run: page.index.runs[state.run].key, frame: null, zoom: null }, true));
  }

  // Links to runs keep the other values of the state.
  function onLink(event) {
    const link = event.target.closest("a");
    if (!link) return;
    const key = /^#run=([0-9a-f]+)$/.exec(link.getAttribute("href") || "");
    if (!link.dataset.runs && !key) return;
    event.preventDefault();
    if (link.dataset.runs) { compareSources(link, event.ctrlKey || event.shiftKey || event.metaKey); return; }
    openRun(indexOf(key[1]));
    byId("runs").scrollIntoView();
  }

  const zoomBy = (factor) => { if (state.charts) state.charts.zoomBy(factor, state.frame); };
  const resetZoom = () => { if (state.charts) state.charts.resetZoom(); };

  const KEYS = {
    ArrowRight: (event) => step(event.shiftKey ? 10 : 1), ArrowLeft: (event) => step(event.shiftKey ? -10 : -1),
    n: () => openRun(state.run + 1), p: () => openRun(state.run - 1), w: () => stepWorst(1), W: () => stepWorst(-1), 0: resetZoom, "+": () => zoomBy(0.5), "-": () => zoomBy(2),
  };

  function onKey(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || /^(SELECT|INPUT|TEXTAREA)$/.test(event.target.tagName)) return;
    const action = KEYS[event.key];
    if (!action) return;
    event.preventDefault();
    action(event);
  }

  // Run, frame and zoom of the address; else the first successful run.
  function fromState() {
    const first = page.index.runs.findIndex((run) => run.outcome === "ok" && run.frames > 0);
    const run = indexOf(page.stateOf("run")), frame = page.stateOf("frame"), zoom = page.stateOf("zoom");
    page.selectRun(run >= 0 ? run : Math.max(first, 0), () => {
      if (run < 0) return;
      if (zoom) state.charts.zoom(...zoom.split(" ").map(Number));
      if (frame !== null && Number(frame) < page.series(run).frames) point(Number(frame), false);
    });
  }

  page.startExplorer = function () {
    const list = byId("run");
    page.index.runs.forEach((run, i) => list.append(page.element("option", { value: i }, name(run))));
    state.views = page.pathViews(byId("paths"), (frame) => point(frame, false));
    list.addEventListener("change", () => openRun(Number(list.value)));
    byId("previous").addEventListener("click", () => openRun(state.run - 1));
    byId("next").addEventListener("click", () => openRun(state.run + 1));
    byId("worst").addEventListener("click", () => stepWorst(1));
    state.inspector = page.inspector((frame) => { state.worstAt = page.series(state.run).worst.indexOf(frame); point(frame, false); });
    document.addEventListener("click", onLink);
    byId("compare-this").addEventListener("click", () => { page.compareRuns([...page.comparedRuns(), state.run]); byId("compare").scrollIntoView(); });
    byId("reset-zoom").addEventListener("click", resetZoom);
    document.addEventListener("keydown", onKey);
    window.addEventListener("resize", () => { if (state.charts) { state.charts.resize(); state.views.redraw(); } });
    page.onState(fromState);
  };
  page.redrawExplorer = function () {
    const frame = state.frame;
    if (state.run >= 0) page.selectRun(state.run, () => { if (frame !== null) point(frame, false); });
  };
  page.selectedRun = () => state.run;
})(window.stillpoint);
