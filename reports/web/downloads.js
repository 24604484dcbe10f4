// SPDX-License-Identifier: BSD-3-Clause
// Download of tables and time series from the data embedded in the page.
"use strict";
(function (page) {
  function save(name, text) {
    const link = page.element("a", { href: URL.createObjectURL(new Blob([text], { type: "text/plain" })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  // Time series of a run as CSV, one line per frame.
  page.seriesText = function (run) {
    const series = page.series(run);
    const names = Object.keys(series.columns);
    const cell = (value) => (value === null ? "" : Number(value.toPrecision(9)).toString());
    const lines = series.t.map((t, i) => [page.frameNumber(series, i), t.toFixed(4), ...names.map((name) => cell(series.columns[name][i]))].join(","));
    return ["frame,t_s," + names.join(","), ...lines].join("\n") + "\n";
  };

  page.startDownloads = function () {
    const list = document.getElementById("file-list");
    const add = (name, action) => {
      const item = page.element("li"), button = page.element("button", { type: "button" }, name);
      button.addEventListener("click", action);
      item.append(button);
      list.append(item);
    };
    add("series of the selected run.csv", () => save("series_" + page.index.runs[page.selectedRun()].key + ".csv", page.seriesText(page.selectedRun())));
    for (const file of page.files) add(file.name, () => save(file.name, file.text));
  };
})(window.stillpoint);
