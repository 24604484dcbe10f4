// SPDX-License-Identifier: BSD-3-Clause
// Time series charts of one run with synchronized cursor and zoom.
"use strict";
(function (page) {
  const STACKED = ["feature_tracking", "feature_detection", "dynamic_recognition", "state_optimization", "object_detection"];
  const cursor = uPlot.sync("frames");

  page.axes = function (label) {
    const axis = { stroke: page.color("faint"), grid: { stroke: page.color("line"), width: 1 }, ticks: { stroke: page.color("line") } };
    // uPlot rounds to three decimals, so that small ticks would repeat.
    const values = (u, ticks) => ticks.map((tick) => Number(tick.toPrecision(10)).toString());
    return [{ ...axis, values, label: "time [s]", labelSize: 18, size: 34 }, { ...axis, values, label, size: 62 }];
  };

  page.number = (u, value) => (value === null || value === undefined ? "-" : Number(value.toPrecision(4)).toString());
  page.line = (label, color, extra) => ({ label, stroke: page.color(color), width: 1.4, value: page.number, spanGaps: false, points: { show: false }, ...extra });
  const { line, number } = page;

  // Cumulative sums of the module times, top layer first; missing values count as 0.
  function stacked(series) {
    const names = STACKED.filter((name) => series.columns["ms:" + name]);
    let sum = new Array(series.frames).fill(0);
    const layers = names.map((name) => {
      const column = series.columns["ms:" + name];
      sum = sum.map((value, i) => value + (column[i] || 0));
      return { name, top: sum };
    });
    return layers.reverse(); // largest sum first, so that the smaller ones are drawn on top
  }

  // Median frame interval [ms], the limit for real-time operation.
  page.frameInterval = function (series) {
    const gaps = series.t.slice(1).map((t, i) => t - series.t[i]).sort((a, b) => a - b);
    return gaps.length ? 1000 * gaps[Math.floor(gaps.length / 2)] : null;
  };

  page.STATUS = ["initializing", "tracking", "degraded", "dead reckoning", "lost", "relocated"];
  const STATUS_COLORS = { initializing: "faint", degraded: "caution", "dead reckoning": "other", lost: "bad", relocated: "good" };

  // Name of the status of a frame. Systems without one: initializing before the first pose, lost without one later.
  page.statusAt = function (series, frame) {
    const status = series.columns.status ? series.columns.status[frame] : null;
    if (status !== null) return page.STATUS[Math.round(status)]; // quantized
    if (!series.columns.x || series.columns.x[frame] !== null) return series.columns.x ? "tracking" : "unknown";
    return series.columns.x.findIndex((x) => x !== null) > frame ? "initializing" : "lost";
  };

  function shadeStatus(plot, series) {
    const { ctx, bbox } = plot;
    ctx.save();
    series.t.forEach((t, i) => {
      const color = STATUS_COLORS[page.statusAt(series, i)];
      if (!color) return;
      ctx.fillStyle = page.color(color) + "33";
      const until = series.t[Math.min(i + 1, series.frames - 1)];
      const left = Math.max(plot.valToPos(series.t[i], "x", true), bbox.left), right = Math.min(plot.valToPos(until, "x", true), bbox.left + bbox.width);
      if (right > left) ctx.fillRect(left, bbox.top, right - left, bbox.height);
    });
    ctx.restore();
  }

  // A bar at the upper edge of the chart while a fault was injected, and its limits.
  function drawFaults(plot, series) {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.fillStyle = page.color("bad");
    for (const { begin, end } of series.faults) {
      const at = (t) => Math.min(Math.max(plot.valToPos(t, "x", true), bbox.left), bbox.left + bbox.width);
      const left = at(begin), right = at(Math.min(end, series.t[series.frames - 1]));
      ctx.fillRect(left, bbox.top, right - left, 5 * devicePixelRatio);
      for (const x of [left, right]) ctx.fillRect(x, bbox.top, 1, bbox.height);
    }
    ctx.restore();
  }

  function definitions(series) {
    const has = (name) => series.columns[name] !== undefined;
    const charts = [];
    if (has("error_m")) {
      const error = { id: "error", title: "Position error after alignment (ATE); background: initializing gray, degraded amber, dead reckoning violet, relocated green, lost red", unit: "m", lines: [line("error [m]", "c0")], data: [series.columns.error_m] };
      if (has("three_sigma_m")) {
        error.title += "; band: three claimed standard deviations, relative to the first pose";
        error.lines.unshift(line("3 sigma, claimed [m]", "c2", { width: 0.7, fill: page.color("c2") + "22" }));
        error.data.unshift(series.columns.three_sigma_m);
      }
      charts.push(error);
    }
    if (has("features"))
      charts.push({ id: "features", title: "Features", unit: "count", lines: [line("tracked", "c0"), line("landmarks in the window", "c2")],
        data: [series.columns.features, series.columns.landmarks] });
    if (has("dynamic"))
      charts.push({ id: "dynamic", title: "Fraction of the features labeled dynamic", unit: "fraction", lines: [line("dynamic", "c1")], data: [series.columns.dynamic] });
    const layers = stacked(series);
    if (layers.length) {
      const limit = page.frameInterval(series);
      const own = (name) => (u, value, s, i) => number(u, i === null ? null : series.columns["ms:" + name][i]);
      charts.push({ id: "modules", title: "Module times, stacked; dashed: frame interval", unit: "ms",
        lines: layers.map((layer, i) => line(layer.name + " [ms]", "c" + i, { fill: page.color("c" + i) + "55", value: own(layer.name) }))
          .concat([line("frame interval [ms]", "bad", { dash: [6, 4] })]),
        data: layers.map((layer) => layer.top).concat([new Array(series.frames).fill(limit)]) });
    }
    return charts;
  }

  // Draws all charts of a run into `place`. Calls onFrame(index) when the pointer moves and onZoom(min, max) on zoom.
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
        scales: { x: { time: false } }, axes: page.axes(chart.unit), series: [{ label: "time [s]", value: number }, ...chart.lines],
        hooks: {
          drawClear: [(u) => shadeStatus(u, series)], draw: [(u) => drawFaults(u, series)],
          setCursor: [(u) => { if (u.cursor.left >= 0 && u.cursor.idx !== null) onFrame(u.cursor.idx); }],
          setScale: [(u, key) => { if (key === "x" && plots.includes(u)) zoomAll(u.scales.x.min, u.scales.x.max); }],
        },
      };
      plots.push(page.plot(options, [series.t, ...chart.data], figure));
    }
    return {
      plots,
      // Moves the cursor of every chart to a frame.
      point(frame) {
        for (const plot of plots) plot.setCursor({ left: plot.valToPos(series.t[frame], "x"), top: plot.over.clientHeight / 2 }, false);
      },
      zoom: zoomAll,
      zoomBy(factor, frame) { if (plots.length) zoomAll(...page.zoomed(plots[0].scales.x, factor, frame === null ? null : series.t[frame], [series.t[0], series.t[series.t.length - 1]])); },
      resetZoom() { zoomAll(series.t[0], series.t[series.t.length - 1]); },
      resize() { for (const plot of plots) plot.setSize({ width: place.clientWidth, height: plot.height }); },
    };
  };
})(window.stillpoint);
