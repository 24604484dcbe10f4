// SPDX-License-Identifier: BSD-3-Clause
// Curves over sweep values and over segment lengths.
"use strict";
(function (page) {
  // One figure per {title, xLabel, unit, values, names, data}: a line of `data` for each of `names` over `values`.
  // All figures are inserted before the first chart is drawn because the layout determines their width.
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
    const lines = curves.names.map((name, i) => page.line(name, "c" + (i % page.LINE_COLORS), { points: { show: true, size: 6 }, spanGaps: true, dash: i < page.LINE_COLORS ? [] : [5, 4] }));
    const axes = page.axes(curves.unit);
    axes[0].label = curves.xLabel;
    page.plot({ width: figure.clientWidth || 900, height: 220, scales: { x: { time: false } }, axes, series: [{ label: curves.xLabel, value: page.number }, ...lines] },
      [curves.values, ...curves.data], figure);
  }

  const finite = (numbers) => numbers.filter((n) => n !== null).sort((a, b) => a - b);
  const median = (numbers) => { const n = numbers.length; return n ? (numbers[Math.floor((n - 1) / 2)] + numbers[Math.floor(n / 2)]) / 2 : null; };
  const counts = (lists) => { const n = lists.map((list) => list.length), least = Math.min(...n), most = Math.max(...n); return " (n = " + (least === most ? least : least + " to " + most) + ")"; };

  // One chart per sweep axis, one line per variant and sequence. @return number of charts
  page.drawSweeps = function (place) {
    const headline = page.index.headline;
    const swept = page.index.runs.filter((run) => run.sweep);
    const axes = [...new Set(swept.map((run) => run.sweep.axis))];
    const error = (run) => { const found = run.metrics.find((metric) => metric[0] === headline.id); return found && run.outcome === "ok" ? found[1] : null; };
    return drawAll(place, axes.map((axis) => {
      const runs = swept.filter((run) => run.sweep.axis === axis);
      const values = [...new Set(runs.map((run) => run.sweep.value))].sort((a, b) => a - b);
      const names = [...new Set(runs.map((run) => run.label + ", " + run.sequence))];
      const points = names.map((name) => values.map((value) => finite(runs.filter((run) => run.sweep.value === value && run.label + ", " + run.sequence === name).map(error))));
      return { title: headline.label + " over " + axis + ": median of the n successful runs at a value", xLabel: axis, unit: headline.unit, values,
        names: names.map((name, i) => name + counts(points[i])), data: points.map((lists) => lists.map(median)) };
    }));
  };

  // One chart per sequence, one line per variant. @return number of charts
  page.drawSegments = function (place) {
    return drawAll(place, page.index.segments.map((figure) => ({ title: figure.sequence, xLabel: "segment length [m]", unit: "% of the length",
      values: figure.lengths, names: figure.curves.map((curve) => curve.label + " (n = " + curve.runs + ")"), data: figure.curves.map((curve) => curve.errors) })));
  };
})(window.stillpoint);
