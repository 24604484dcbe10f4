// SPDX-License-Identifier: BSD-3-Clause
// Charts whose legend shows and hides lines by keyboard as well as by mouse.
"use strict";
(function (page) {
  // As `new uPlot`.
  page.plot = function (options, data, place) {
    const hooks = { ...options.hooks, setSeries: [(u, i) => mark(u, i)] };
    const heads = [];
    const mark = (u, i) => { if (heads[i]) heads[i].setAttribute("aria-pressed", u.series[i].show); };
    const plot = new uPlot({ ...options, hooks }, data, place);
    plot.root.querySelectorAll(".u-legend .u-series").forEach((row, i) => {
      if (i === 0) return; // the horizontal axis is not a line
      const head = heads[i] = row.querySelector("th");
      for (const [name, value] of Object.entries({ tabindex: "0", role: "button", title: "Show or hide this line" })) head.setAttribute(name, value);
      mark(plot, i);
      head.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        plot.setSeries(i, { show: !plot.series[i].show });
      });
    });
    return plot;
  };

  // The mark of a missing value; Tab reaches the reason.
  page.missing = (reason) => page.element("abbr", { tabindex: "0", title: reason }, "n/a");
})(window.stillpoint);
