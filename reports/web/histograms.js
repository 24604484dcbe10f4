// SPDX-License-Identifier: BSD-3-Clause
// Histogram of the time per frame for each module of the selected run, on a logarithmic axis.
"use strict";
(function (page) {
  const BINS = 32, WIDTH = 260, HEIGHT = 110, FOOT = 18;

  function svg(tag, attributes, text) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    if (text !== undefined) element.textContent = text;
    return element;
  }

  const milliseconds = (value) => Number(value.toPrecision(3)) + " ms";

  // `position` maps a time to 0 .. 1 on the logarithmic axis from the smallest to the largest time.
  function histogram(name, times, limit) {
    const sorted = [...times].sort((a, b) => a - b), low = Math.log(Math.max(sorted[0], 1e-4)), high = Math.log(sorted[sorted.length - 1]);
    const position = (value) => (high > low ? (Math.log(Math.max(value, 1e-4)) - low) / (high - low) : 0.5);
    const counts = new Array(BINS).fill(0);
    for (const time of sorted) counts[Math.min(BINS - 1, Math.floor(position(time) * BINS))] += 1;
    const largestCount = Math.max(...counts), median = sorted[Math.floor(sorted.length / 2)];
    const chart = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img",
      "aria-label": `${name}: ${sorted.length} frames, ${milliseconds(sorted[0])} to ${milliseconds(sorted[sorted.length - 1])}, median ${milliseconds(median)}` });
    counts.forEach((count, i) => {
      const height = (HEIGHT - FOOT - 4) * count / largestCount;
      chart.append(svg("rect", { x: (i * WIDTH / BINS).toFixed(1), y: (HEIGHT - FOOT - height).toFixed(1), width: (WIDTH / BINS - 1).toFixed(1), height: height.toFixed(1) }));
    });
    const mark = (value, kind) => chart.append(svg("line", { class: kind, x1: position(value) * WIDTH, x2: position(value) * WIDTH, y1: 0, y2: HEIGHT - FOOT }));
    mark(median, "median");
    if (limit !== null && position(limit) >= 0 && position(limit) <= 1) mark(limit, "limit");
    chart.append(svg("text", { x: 0, y: HEIGHT - 4 }, milliseconds(sorted[0])),
      svg("text", { x: WIDTH, y: HEIGHT - 4, "text-anchor": "end" }, milliseconds(sorted[sorted.length - 1])));
    const figure = page.element("figure", { "data-module": name });
    figure.append(page.element("figcaption", {}, name + ", median " + milliseconds(median)), chart);
    return figure;
  }

  page.drawHistograms = function (place, series) {
    const limit = page.frameInterval(series);
    const modules = Object.entries(series.columns).filter(([name]) => name.startsWith("ms:"));
    place.replaceChildren(...modules.map(([name, column]) => [name.slice(3), column.filter((time) => time !== null && time > 0)])
      .filter(([, times]) => times.length > 1).map(([name, times]) => histogram(name, times, limit)));
    return place.childElementCount;
  };
})(window.stillpoint);
