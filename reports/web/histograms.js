// SPDX-License-Identifier: BSD-3-Clause
// How the times of the selected run's modules are spread: one small histogram each, on a logarithmic axis.
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

  // The share of the axis from the smallest to the largest time at which a value lies.
  function histogram(name, times, limit) {
    const sorted = [...times].sort((a, b) => a - b), low = Math.log(Math.max(sorted[0], 1e-4)), high = Math.log(sorted[sorted.length - 1]);
    const share = (value) => (high > low ? (Math.log(Math.max(value, 1e-4)) - low) / (high - low) : 0.5);
    const counts = new Array(BINS).fill(0);
    for (const time of sorted) counts[Math.min(BINS - 1, Math.floor(share(time) * BINS))] += 1;
    const tallest = Math.max(...counts), middle = sorted[Math.floor(sorted.length / 2)];
    const picture = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img",
      "aria-label": `${name}: ${sorted.length} frames, ${milliseconds(sorted[0])} to ${milliseconds(sorted[sorted.length - 1])}, median ${milliseconds(middle)}` });
    counts.forEach((count, i) => {
      const height = (HEIGHT - FOOT - 4) * count / tallest;
      picture.append(svg("rect", { x: (i * WIDTH / BINS).toFixed(1), y: (HEIGHT - FOOT - height).toFixed(1), width: (WIDTH / BINS - 1).toFixed(1), height: height.toFixed(1) }));
    });
    const mark = (value, kind) => picture.append(svg("line", { class: kind, x1: share(value) * WIDTH, x2: share(value) * WIDTH, y1: 0, y2: HEIGHT - FOOT }));
    mark(middle, "median");
    if (limit !== null && share(limit) >= 0 && share(limit) <= 1) mark(limit, "limit");
    picture.append(svg("text", { x: 0, y: HEIGHT - 4 }, milliseconds(sorted[0])),
      svg("text", { x: WIDTH, y: HEIGHT - 4, "text-anchor": "end" }, milliseconds(sorted[sorted.length - 1])));
    const figure = page.element("figure", { "data-module": name });
    figure.append(page.element("figcaption", {}, name + ", median " + milliseconds(middle)), picture);
    return figure;
  }

  page.drawHistograms = function (place, series) {
    const limit = page.deadline(series);
    const modules = Object.entries(series.columns).filter(([name]) => name.startsWith("ms:"));
    place.replaceChildren(...modules.map(([name, column]) => [name.slice(3), column.filter((time) => time !== null && time > 0)])
      .filter(([, times]) => times.length > 1).map(([name, times]) => histogram(name, times, limit)));
    return place.childElementCount;
  };
})(window.stillpoint);
