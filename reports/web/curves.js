// SPDX-License-Identifier: BSD-3-Clause
// Curves over something else than time: values of a sweep, lengths of the way.
"use strict";
(function (page) {
  // Of each {title, across, unit, values, names, data} a figure with a line of `data` for each of `names`, over
  // `values`. All figures stand before the first chart is drawn: they share the width.
  function drawAll(place, charts) {
    const figures = charts.map((curves) => {
      const figure = page.element("figure");
      figure.append(page.element("figcaption", {}, curves.title));
      place.append(figure);
      return figure;
    });
    charts.forEach((curves, i) => draw(figures[i], curves));
    return charts.length;
  }

  function draw(figure, curves) {
    const lines = curves.names.map((name, i) => page.line(name, "c" + (i % 7), { points: { show: true, size: 6 }, spanGaps: true, dash: i < 7 ? [] : [5, 4] }));
    const axes = page.axes(curves.unit);
    axes[0].label = curves.across;
    new uPlot({ width: figure.clientWidth || 900, height: 220, scales: { x: { time: false } }, axes, series: [{ label: curves.across, value: page.number }, ...lines] },
      [curves.values, ...curves.data], figure);
  }

  const middle = (numbers) => { const known = numbers.filter((n) => n !== null).sort((a, b) => a - b); return known.length ? known[Math.floor((known.length - 1) / 2)] : null; };

  // One chart for each axis, one line for each variant and sequence. @return number of charts
  page.drawSweeps = function (place) {
    const swept = page.index.runs.filter((run) => run.sweep);
    const axes = [...new Set(swept.map((run) => run.sweep.axis))];
    const error = (run) => { const found = run.metrics.find((metric) => metric[0] === "ate_rmse_m"); return found && run.outcome === "ok" ? found[1] : null; };
    return drawAll(place, axes.map((axis) => {
      const runs = swept.filter((run) => run.sweep.axis === axis);
      const values = [...new Set(runs.map((run) => run.sweep.value))].sort((a, b) => a - b);
      const names = [...new Set(runs.map((run) => run.label + ", " + run.sequence))];
      const data = names.map((name) => values.map((value) => middle(runs.filter((run) => run.sweep.value === value && run.label + ", " + run.sequence === name).map(error))));
      return { title: "RMSE of the position error over " + axis, across: axis, unit: "m", values, names, data };
    }));
  };

  // One chart for each sequence, one line for each variant. @return number of charts
  page.drawSegments = function (place) {
    return drawAll(place, page.index.segments.map((figure) => ({ title: figure.sequence, across: "length of the stretch [m]", unit: "% of the length",
      values: figure.lengths, names: figure.curves.map((curve) => curve.label), data: figure.curves.map((curve) => curve.errors) })));
  };
})(window.stillpoint);
