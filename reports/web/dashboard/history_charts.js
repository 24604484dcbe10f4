// SPDX-License-Identifier: BSD-3-Clause
// Charts of metrics over commits with synchronized cursor and zoom.
"use strict";
(function (page) {
  const cursor = uPlot.sync("commits");
  const COLORS = { open: "bad", accepted: "faint", improved: "good", resolved: "caution", neutral: "other" };
  const label = (i) => (page.index.commits[i] ? page.index.commits[i].label : "");
  const number = (u, value) => (value === null || value === undefined ? "-" : Number(value.toPrecision(4)).toString());

  // Values by commit, null where not measured.
  page.valuesOf = function (series) {
    const values = new Array(page.index.commits.length).fill(null);
    series.commits.forEach((commit, i) => { values[commit] = series.values[i]; });
    return values;
  };

  const shiftsOf = (index) => page.index.shifts.filter((shift) => shift.series === index);

  // [first commit, last commit, level] of each segment between shifts.
  function levelSpans(index) {
    const series = page.index.series[index], shifts = shiftsOf(index);
    const spans = [];
    shifts.forEach((shift, i) => {
      const start = i === 0 ? series.commits[0] : shifts[i - 1].after;
      const end = i + 1 < shifts.length ? shifts[i + 1].before : series.commits[series.commits.length - 1];
      if (i === 0) spans.push([start, shift.before, shift.from]);
      spans.push([shift.after, end, shift.to]);
    });
    return spans;
  }

  function strokeLine(u, color, dash, from, to) {
    u.ctx.strokeStyle = color;
    u.ctx.setLineDash(dash);
    u.ctx.beginPath();
    u.ctx.moveTo(...from);
    u.ctx.lineTo(...to);
    u.ctx.stroke();
  }

  // A vertical line at each shift, dashed levels between shifts, and dotted drift lines.
  function drawChanges(u, line) {
    const { left, top, width, height } = u.bbox;
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(left, top, width, height);
    u.ctx.clip();
    u.ctx.lineWidth = 1.5 * devicePixelRatio;
    for (const shift of shiftsOf(line.index)) {
      const x = u.valToPos((shift.before + shift.after) / 2, "x", true);
      strokeLine(u, page.color(COLORS[shift.state]), [], [x, top], [x, top + height]);
    }
    for (const drift of page.index.drifts.filter((one) => one.series === line.index)) {
      strokeLine(u, page.color(drift.worse ? "worse" : "better"), [1, 4], [u.valToPos(drift.first, "x", true), u.valToPos(drift.from, line.scale, true)],
        [u.valToPos(drift.last, "x", true), u.valToPos(drift.to, line.scale, true)]);
    }
    for (const [start, end, level] of levelSpans(line.index)) {
      const y = u.valToPos(level, line.scale, true);
      strokeLine(u, page.color("ink"), [5, 4], [u.valToPos(start - 0.4, "x", true), y], [u.valToPos(end + 0.4, "x", true), y]);
    }
    u.ctx.restore();
  }

  function axis(extra) {
    return { stroke: page.color("faint"), grid: { stroke: page.color("line"), width: 1 }, ticks: { stroke: page.color("line") }, ...extra };
  }

  // The value range plus a margin.
  function valueRange(u, min, max) {
    if (min === null) return [0, 1];
    const margin = max > min ? 0.08 * (max - min) : Math.abs(min) * 0.1 || 1;
    return [min - margin, max + margin];
  }

  // lines: [{index, scale, color}]; hooks: {onCommit, onZoom, onOpen}.
  function chart(figure, lines, height, hooks) {
    const scales = { x: { time: false } };
    const axes = [axis({ values: (u, splits) => splits.map((at) => (Number.isInteger(at) ? label(at) : "")), space: 90, size: 34, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] })];
    lines.forEach((line, i) => {
      scales[line.scale] = { range: valueRange };
      const unit = page.index.series[line.index].unit;
      axes.push(axis({ scale: line.scale, side: i === 0 ? 3 : 1, size: 62, values: (u, splits) => splits.map((at) => Number(at.toPrecision(5)).toString()), label: lines.length > 1 ? unit || "ratio" : undefined, labelSize: 16, grid: { show: i === 0, stroke: page.color("line"), width: 1 } }));
    });
    const shown = lines.map((line) => ({ label: page.index.series[line.index].metric, scale: line.scale, stroke: page.color(line.color), width: 1.3,
      spanGaps: true, value: number, points: { show: true, size: 5, fill: page.color(line.color) } }));
    const options = {
      width: figure.clientWidth || 900, height, scales, axes,
      cursor: { sync: { key: cursor.key }, drag: { x: true, y: false }, bind: { dblclick: () => null } },
      series: [{ label: "commit", value: (u, at) => (at === null ? "-" : label(at)) }, ...shown],
      hooks: {
        draw: [(u) => lines.forEach((line) => drawChanges(u, line))],
        setCursor: [(u) => { if (u.cursor.left >= 0 && u.cursor.idx !== null) hooks.onCommit(u.cursor.idx); }],
        setScale: [(u, key) => { if (key === "x") hooks.onZoom(u.scales.x.min, u.scales.x.max); }],
      },
    };
    const commits = page.index.commits.map((_, i) => i);
    const plot = page.plot(options, [commits, ...lines.map((line) => page.valuesOf(page.index.series[line.index]))], figure);
    // A click without dragging opens the commit; a drag zooms.
    let down = 0;
    plot.over.addEventListener("mousedown", (event) => { down = event.clientX; });
    plot.over.addEventListener("click", (event) => { if (Math.abs(event.clientX - down) < 3 && plot.cursor.idx !== null) hooks.onOpen(plot.cursor.idx); });
    return plot;
  }

  // Draws groups [{place, title, id, lines, height}] as charts with synchronized cursor and zoom.
  page.drawHistory = function (groups, onCommit, onOpen, onZoomed) {
    const plots = [];
    let zooming = false;
    const zoom = (min, max) => {
      if (zooming || plots.length < groups.length) return;
      zooming = true;
      for (const plot of plots) plot.setScale("x", { min, max });
      zooming = false;
      onZoomed(min, max);
    };
    for (const group of groups) {
      const figure = page.element("figure", { "data-chart": group.id });
      figure.append(page.element("figcaption", {}, group.title));
      group.place.append(figure);
      plots.push(chart(figure, group.lines, group.height, { onCommit, onOpen, onZoom: zoom }));
    }
    const last = page.index.commits.length - 1;
    const whole = [-0.5, Math.max(last, 1) + 0.5], resetZoom = () => zoom(...whole);
    resetZoom();
    return {
      resetZoom,
      zoomBy(factor, commit) { if (plots.length) zoom(...page.zoomed(plots[0].scales.x, factor, commit, whole)); },
      point(commit) { for (const plot of plots) plot.setCursor({ left: plot.valToPos(commit, "x"), top: plot.over.clientHeight / 2 }, false); },
      resize() { for (const plot of plots) plot.setSize({ width: plot.root.parentElement.clientWidth, height: plot.height }); },
      destroy() { for (const plot of plots) plot.destroy(); },
    };
  };
})(window.stillpoint);
