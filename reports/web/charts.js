// SPDX-License-Identifier: BSD-3-Clause
// Linked charts over the time of one run: a pointer or a zoom in one is in all.
"use strict";
(function (page) {
  const STACKED = ["feature_tracking", "feature_detection", "dynamic_recognition", "state_optimization", "object_detection"];
  const cursor = uPlot.sync("frames");

  function axes(label) {
    const axis = { stroke: page.color("faint"), grid: { stroke: page.color("line"), width: 1 }, ticks: { stroke: page.color("line") } };
    return [{ ...axis, label: "time [s]", labelSize: 18, size: 34 }, { ...axis, label, size: 62 }];
  }

  const number = (u, value) => (value === null || value === undefined ? "-" : Number(value.toPrecision(4)).toString());
  function line(label, color, extra) {
    return { label, stroke: page.color(color), width: 1.4, value: number, spanGaps: false, points: { show: false }, ...extra };
  }

  // Each layer upon the ones below; a frame without any stays empty.
  function stacked(series) {
    const names = STACKED.filter((name) => series.columns["ms:" + name]);
    let sum = new Array(series.frames).fill(0);
    const layers = names.map((name) => {
      const column = series.columns["ms:" + name];
      sum = sum.map((value, i) => value + (column[i] || 0));
      return { name, top: sum };
    });
    return layers.reverse(); // the widest first, so that the others are drawn over it
  }

  // Median time between frames [ms]: who takes longer falls behind.
  function deadline(series) {
    const gaps = series.t.slice(1).map((t, i) => t - series.t[i]).sort((a, b) => a - b);
    return gaps.length ? 1000 * gaps[Math.floor(gaps.length / 2)] : null;
  }

  function definitions(series) {
    const has = (name) => series.columns[name] !== undefined;
    const charts = [];
    if (has("error_m"))
      charts.push({ id: "error", title: "Position error after alignment", unit: "m", lines: [line("error [m]", "c0")], data: [series.columns.error_m] });
    if (has("features"))
      charts.push({ id: "features", title: "Features", unit: "count", lines: [line("tracked", "c0"), line("in the window", "c2")],
        data: [series.columns.features, series.columns.landmarks] });
    if (has("dynamic"))
      charts.push({ id: "dynamic", title: "Share of the features that are held to move", unit: "share", lines: [line("dynamic", "c1")], data: [series.columns.dynamic] });
    const layers = stacked(series);
    if (layers.length) {
      const limit = deadline(series);
      const own = (name) => (u, value, s, i) => number(u, i === null ? null : series.columns["ms:" + name][i]);
      charts.push({ id: "modules", title: "Time of the modules, stacked; dashed: the time until the next picture", unit: "ms",
        lines: layers.map((layer, i) => line(layer.name + " [ms]", "c" + i, { fill: page.color("c" + i) + "55", value: own(layer.name) }))
          .concat([line("next picture [ms]", "bad", { dash: [6, 4] })]),
        data: layers.map((layer) => layer.top).concat([new Array(series.frames).fill(limit)]) });
    }
    return charts;
  }

  // Draws all charts of a run into `place`; onFrame(index) hears the pointer, onZoom(min, max) the zoom.
  page.drawCharts = function (place, series, onFrame, onZoom) {
    place.replaceChildren();
    const plots = [];
    let zooming = false;
    const zoomAll = (min, max) => {
      if (zooming) return;
      zooming = true;
      for (const plot of plots) plot.setScale("x", { min, max });
      zooming = false;
      onZoom(min, max);
    };
    for (const chart of definitions(series)) {
      const figure = page.element("figure", { "data-chart": chart.id });
      figure.append(page.element("figcaption", {}, chart.title));
      place.append(figure);
      const options = {
        width: figure.clientWidth || 900, height: chart.id === "modules" ? 220 : 150,
        cursor: { sync: { key: cursor.key }, drag: { x: true, y: false } },
        scales: { x: { time: false } }, axes: axes(chart.unit), series: [{ label: "time [s]", value: number }, ...chart.lines],
        hooks: {
          setCursor: [(u) => { if (u.cursor.left >= 0 && u.cursor.idx !== null) onFrame(u.cursor.idx); }],
          setScale: [(u, key) => { if (key === "x" && plots.includes(u)) zoomAll(u.scales.x.min, u.scales.x.max); }],
        },
      };
      plots.push(new uPlot(options, [series.t, ...chart.data], figure));
    }
    return {
      plots,
      // Puts the pointer of every chart at a frame.
      point(frame) {
        for (const plot of plots) plot.setCursor({ left: plot.valToPos(series.t[frame], "x"), top: plot.over.clientHeight / 2 }, false);
      },
      zoom: zoomAll,
      whole() { zoomAll(series.t[0], series.t[series.t.length - 1]); },
      resize() { for (const plot of plots) plot.setSize({ width: place.clientWidth, height: plot.height }); },
    };
  };

  // Curves over the values of a sweep: one chart for each axis, one line for each variant and sequence.
  page.drawSweeps = function (place) {
    const swept = page.index.runs.filter((run) => run.sweep);
    const axesOf = [...new Set(swept.map((run) => run.sweep.axis))];
    const error = (run) => { const found = run.metrics.find((metric) => metric[0] === "ate_rmse_m"); return found && run.outcome === "ok" ? found[1] : null; };
    const middle = (numbers) => { const known = numbers.filter((n) => n !== null).sort((a, b) => a - b); return known.length ? known[Math.floor((known.length - 1) / 2)] : null; };
    for (const axis of axesOf) {
      const runs = swept.filter((run) => run.sweep.axis === axis);
      const values = [...new Set(runs.map((run) => run.sweep.value))].sort((a, b) => a - b);
      const names = [...new Set(runs.map((run) => run.label + ", " + run.sequence))];
      const data = names.map((name) => values.map((value) => middle(runs.filter((run) => run.sweep.value === value && run.label + ", " + run.sequence === name).map(error))));
      const figure = page.element("figure");
      figure.append(page.element("figcaption", {}, "RMSE of the position error over " + axis));
      place.append(figure);
      const lines = names.map((name, i) => line(name, "c" + (i % 7), { points: { show: true, size: 6 } }));
      const labels = axes("m");
      labels[0].label = axis;
      new uPlot({ width: place.clientWidth || 900, height: 220, scales: { x: { time: false } }, axes: labels, series: [{ label: axis, value: number }, ...lines] },
        [values, ...data], figure);
    }
    return axesOf.length;
  };
})(window.stillpoint);
