// SPDX-License-Identifier: BSD-3-Clause
// Initializes the report page.
"use strict";
(function (page) {
  const root = document.documentElement, byId = (id) => document.getElementById(id);

  function showEnvironment() {
    const seen = new Set();
    const table = page.element("table", { class: "stacked" });
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
    byId("environment").append(table);
  }

  function showTheme() {
    const theme = page.stateOf("theme");
    if (theme) root.dataset.theme = theme; else delete root.dataset.theme;
    byId("spread").checked = page.stateOf("spread") !== null;
    document.body.classList.toggle("with-spread", byId("spread").checked);
  }

  function toggleTheme() {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    page.setState({ theme: dark ? "light" : "dark" });
    showTheme();
    page.redrawExplorer();
    page.redrawCompare();
    page.redrawFlames();
  }

  byId("theme").addEventListener("click", toggleTheme);
  byId("spread").addEventListener("change", (event) => { page.setState({ spread: event.target.checked && "1" }); showTheme(); });
  page.onState(showTheme);
  page.stackTables(document);
  page.startMatrix();
  page.startCompare();
  page.startExplorer();
  page.startState();
  page.startDownloads();
  showEnvironment();
  page.startFlames();
  const reveal = (section, draw) => { const place = byId(section); place.hidden = false; place.hidden = draw() === 0; };
  reveal("sweeps", () => page.drawSweeps(byId("curves")));
  reveal("segments", () => page.drawSegments(byId("segment-curves")));
  for (const link of document.querySelectorAll("nav a")) link.hidden = byId(link.getAttribute("href").slice(1)).hidden;
  root.dataset.readyMs = Math.round(performance.now());
})(window.stillpoint);
