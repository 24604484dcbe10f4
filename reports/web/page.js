// SPDX-License-Identifier: BSD-3-Clause
// Initializes the report page.
"use strict";
(function (page) {
  const root = document.documentElement;

  function showEnvironment() {
    const seen = new Set();
    const table = page.element("table");
    for (const manifest of Object.values(page.index.manifests)) {
      if (!manifest) continue;
      for (const part of ["host", "build"]) {
        for (const [name, value] of Object.entries(manifest[part] || {})) {
          const text = typeof value === "object" ? JSON.stringify(value) : String(value);
          if (seen.has(part + name + text)) continue;
          seen.add(part + name + text);
          const row = page.element("tr");
          const cell = page.element("td", {}, text);
          cell.style.textAlign = "left";
          row.append(page.element("th", { scope: "row" }, part + ": " + name), cell);
          table.append(row);
        }
      }
    }
    document.getElementById("environment").append(table);
  }

  function toggleTheme() {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
    page.redrawExplorer();
    page.redrawFlames();
  }

  document.getElementById("theme").addEventListener("click", toggleTheme);
  document.getElementById("spread").addEventListener("change", (event) => document.body.classList.toggle("with-spread", event.target.checked));
  page.startExplorer();
  page.startDownloads();
  showEnvironment();
  page.startFlames();
  const reveal = (section, draw) => { const place = document.getElementById(section); place.hidden = false; place.hidden = draw() === 0; };
  reveal("sweeps", () => page.drawSweeps(document.getElementById("curves")));
  reveal("segments", () => page.drawSegments(document.getElementById("segment-curves")));
  root.dataset.readyMs = Math.round(performance.now());
})(window.stillpoint);
