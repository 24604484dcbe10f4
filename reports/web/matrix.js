// SPDX-License-Identifier: BSD-3-Clause
// The table of one metric as a matrix of variants and sequences: every run a dot, sorted, filtered, copied.
"use strict";
(function (page) {
  const byId = (id) => document.getElementById(id);
  const WIDTH = 92, HEIGHT = 14, MARGIN = 5;
  const MAX_COLUMNS = 7; // with more and fewer rows than columns, rows and columns are exchanged
  const tables = new Map();
  let shown = null;

  // Rows, columns and cells of a table, which keep their elements: links, footnotes and tooltips.
  function model(table) {
    const heads = [...table.tHead.rows[table.tHead.rows.length - 1].cells];
    const first = table.tHead.rows.length > 1 ? 0 : 1;
    const rows = [...table.tBodies[0].rows].map((row) => ({ name: row.cells[0].textContent, cells: [...row.cells].slice(1) }));
    const columns = heads.slice(first).map((head) => ({ name: head.textContent, title: head.title }));
    const isMatrix = table.tHead.rows.length === 1 && table.id !== "table-module_times";
    return { table, metric: table.id.replace("table-", ""), rows, columns, isMatrix, heading: table.tHead.rows[0].cells[0].textContent,
      exchanged: isMatrix && columns.length > MAX_COLUMNS && columns.length > rows.length };
  }

  const keysOf = (cell) => { const link = cell.querySelector("a[data-runs]"); return link ? link.dataset.runs.split(" ") : []; };
  const textOf = (cell) => { const link = cell.querySelector("a[data-runs]"); return (link || cell).textContent; };
  const numberOf = (cell) => { const value = parseFloat(textOf(cell)); return Number.isFinite(value) ? value : null; };

  function valueOf(run, metric) {
    const found = run.metrics.find(([name]) => name === metric);
    return run.outcome === "ok" && found ? found[1] : null;
  }

  // The median of a cell with all of its digits: that of the runs, of which equal ones count once, if it is the one
  // that the cell shows; else the shown number.
  function medianOf(cell, runs, metric) {
    const shown = numberOf(cell), values = [...new Set(runs.map((run) => valueOf(run, metric)).filter((value) => value !== null))].sort((a, b) => a - b);
    if (shown === null || !values.length) return shown;
    const median = (values[Math.floor((values.length - 1) / 2)] + values[Math.floor(values.length / 2)]) / 2;
    const decimals = (/\.(\d+)/.exec(textOf(cell)) || ["", ""])[1].length;
    return Math.abs(median - shown) <= 0.51 * 10 ** -decimals ? median : shown;
  }

  // Dots of the runs of a cell on the scale of its sequence; failed runs are crosses at the right edge.
  function strip(runs, metric, low, high, median) {
    const at = (value) => MARGIN + (high > low ? (value - low) / (high - low) : 0.5) * (WIDTH - 4 * MARGIN);
    const space = "http://www.w3.org/2000/svg";
    const svg = document.createElementNS(space, "svg");
    const add = (tag, attributes) => { const part = document.createElementNS(space, tag); for (const [name, value] of Object.entries(attributes)) part.setAttribute(name, value); svg.append(part); };
    for (const [name, value] of Object.entries({ width: WIDTH, height: HEIGHT, viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "dots", "aria-hidden": "true" })) svg.setAttribute(name, value);
    add("line", { x1: MARGIN, x2: WIDTH - 3 * MARGIN, y1: HEIGHT / 2, y2: HEIGHT / 2 });
    if (median !== null) add("line", { x1: at(median).toFixed(1), x2: at(median).toFixed(1), y1: 1, y2: HEIGHT - 1, class: "median" });
    for (const run of runs) {
      const value = valueOf(run, metric);
      if (value !== null) add("circle", { cx: at(value).toFixed(1), cy: HEIGHT / 2, r: 3 });
      else if (run.outcome !== "ok") add("path", { d: `M${WIDTH - 11} 3l8 8m0 -8l-8 8`, class: "failed" });
    }
    return svg;
  }

  function addDots(own) {
    const runs = new Map(page.index.runs.map((run) => [run.key, run]));
    own.columns.forEach((_, column) => {
      const lists = own.rows.map((row) => keysOf(row.cells[column]).map((key) => runs.get(key)).filter((run) => run));
      const values = lists.flat().map((run) => valueOf(run, own.metric)).filter((value) => value !== null).sort((a, b) => a - b);
      const low = values[0], high = values.at(-1); // as arguments of Math.min, 100,000 values exceed the stack
      own.rows.forEach((row, i) => { if (lists[i].length) row.cells[column].append(strip(lists[i], own.metric, low, high, medianOf(row.cells[column], lists[i], own.metric))); });
    });
  }

  // Why a cell has no number.
  function explainEmpty(own) {
    for (const row of own.rows) for (const cell of row.cells) {
      if (textOf(cell).trim() !== "-") continue;
      const reason = keysOf(cell).length ? "the runs have no value of this metric" : "no run", link = cell.querySelector("a");
      cell.title = cell.title || reason;
      if (link) link.title = cell.title; else cell.replaceChildren(page.missing(cell.title));
    }
  }

  const chosen = () => new Set((page.stateOf("hide") || "").split("\n"));
  const plain = (name) => name.replace(/ \[[^\]]*\]$/, "");

  // The shown rows and columns: {heading, columns: names, rows: [{name, cells}]}, as on the screen.
  function view(own) {
    const filter = byId("filter").value.trim().toLowerCase(), hidden = chosen();
    const unit = (/\[[^\]]*\]$/.exec(own.columns[0] ? own.columns[0].name : "") || [""])[0];
    let { rows } = own, columns = own.columns.map((column, i) => ({ ...column, i }));
    if (own.isMatrix) {
      columns = columns.filter((column) => !hidden.has(plain(column.name)));
      const matches = (name) => name.toLowerCase().includes(filter);
      const byRow = rows.filter((row) => matches(row.name)), byColumn = columns.filter((column) => matches(column.name));
      if (filter && (byRow.length || byColumn.length)) { if (byRow.length) rows = byRow; if (byColumn.length && !byRow.length) columns = byColumn; } else if (filter) rows = [];
    }
    let lines = rows.map((row) => ({ name: row.name, cells: columns.map((column) => row.cells[column.i]) }));
    let names = columns.map((column) => (own.isMatrix ? plain(column.name) : column.name));
    if (own.exchanged) {
      const before = lines;
      lines = names.map((name, i) => ({ name, cells: before.map((row) => row.cells[i]) }));
      names = before.map((row) => row.name);
    }
    const sort = page.stateOf("sort") || "", falling = sort.startsWith("-"), by = names.indexOf(sort.replace(/^-/, ""));
    if (by >= 0) {
      const key = (line) => numberOf(line.cells[by]);
      lines.sort((a, b) => (key(a) === null) - (key(b) === null) || (falling ? key(b) - key(a) : key(a) - key(b)));
    }
    return { heading: own.exchanged ? "sequence" : own.heading, unit: own.isMatrix ? unit : "", names, lines, by, falling };
  }

  function draw() {
    const own = shown, now = view(own);
    own.shown = now;
    byId("matrix-note").textContent = !own.isMatrix ? "" : (now.lines.length ? "" : "No variant or sequence contains this text. ")
      + "Dots: runs, one scale per sequence, from its smallest to its largest value; line: median" + (own.table.querySelector(".dots .failed") ? "; cross: failed run" : "") + ".";
    if (!own.isMatrix) return; // may have two rows of headings
    const head = page.element("tr");
    head.append(page.element("th", { scope: "col" }, now.heading + (now.unit ? " " + now.unit : "")));
    now.names.forEach((name, i) => {
      const cell = page.element("th", { scope: "col", "aria-sort": i !== now.by ? "none" : now.falling ? "descending" : "ascending" });
      const button = page.element("button", { type: "button", class: "sort", title: "Sort by " + name }, name);
      button.addEventListener("click", () => { page.setState({ sort: (i === now.by && !now.falling ? "-" : "") + name }); draw(); byId("results").querySelectorAll("details:not([hidden]) .sort")[i].focus(); });
      cell.append(button);
      head.append(cell);
    });
    own.table.tHead.replaceChildren(head);
    own.table.tBodies[0].replaceChildren(...now.lines.map((line) => {
      const row = page.element("tr");
      line.cells.forEach((cell, i) => { cell.dataset.label = now.names[i]; });
      row.append(page.element("th", { scope: "row" }, line.name), ...line.cells);
      return row;
    }));
  }

  function listColumns() {
    const hidden = chosen();
    byId("columns").hidden = !shown.isMatrix;
    byId("filter").disabled = !shown.isMatrix;
    byId("column-list").replaceChildren(...shown.columns.map((column) => {
      const name = plain(column.name), label = page.element("label"), box = page.element("input", { type: "checkbox", value: name });
      box.checked = !hidden.has(name);
      box.addEventListener("change", () => {
        const out = [...byId("column-list").querySelectorAll("input:not(:checked)")].map((one) => one.value);
        page.setState({ hide: out.join("\n") });
        draw();
      });
      label.append(box, " " + name);
      return label;
    }));
  }

  function show(id) {
    shown = tables.get(id) || tables.values().next().value;
    byId("metric").value = shown.metric;
    for (const own of tables.values()) { const part = own.table.closest("details"); part.hidden = own !== shown; part.open = true; }
    listColumns();
    draw();
  }

  const escapes = {
    Markdown: (text) => text.replace(/[\\|*_<>`]/g, "\\$&"),
    LaTeX: (text) => text.replace(/[\\{}$&#%_~^]/g, (letter) => ({ "\\": "\\textbackslash{}", "~": "\\textasciitilde{}", "^": "\\textasciicircum{}" }[letter] || "\\" + letter)),
    CSV: (text) => (/[",\n]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text),
  };

  // The shown table as text; best medians are bold where the format has it.
  page.matrixText = function (format) {
    const now = shown.shown, escape = escapes[format];
    const bold = { Markdown: (text) => "**" + text + "**", LaTeX: (text) => "\\textbf{" + text + "}", CSV: (text) => text }[format];
    const lines = [[now.heading + (now.unit ? " " + now.unit : ""), ...now.names].map(escape),
      ...now.lines.map((line) => [escape(line.name), ...line.cells.map((cell) => (cell.querySelector("strong") ? bold(escape(textOf(cell))) : escape(textOf(cell))))])];
    if (format === "CSV") return lines.map((line) => line.join(",")).join("\n") + "\n";
    if (format === "Markdown") return [lines[0], lines[0].map((_, i) => (i ? "---:" : "---")), ...lines.slice(1)].map((line) => "| " + line.join(" | ") + " |").join("\n") + "\n";
    return `\\begin{tabular}{l${"r".repeat(now.names.length)}}\n\\toprule\n${lines[0].join(" & ")} \\\\\n\\midrule\n`
      + lines.slice(1).map((line) => line.join(" & ") + " \\\\\n").join("") + "\\bottomrule\n\\end{tabular}\n";
  };

  function copy(format) {
    const place = byId("copied");
    place.hidden = false;
    place.value = page.matrixText(format);
    place.rows = Math.min(place.value.split("\n").length, 12);
    place.focus();
    place.select();
    document.execCommand("copy");
  }

  page.startMatrix = function () {
    for (const table of byId("results").querySelectorAll(".table > table[id^=table-]")) {
      const own = model(table);
      tables.set(own.metric, own);
      table.closest("details").classList.add("matrix-table");
      if (own.exchanged) for (const note of table.closest("details").querySelectorAll(".notes li")) if (note.textContent.startsWith("Bold: ")) note.textContent = note.textContent.replace(" of a column,", " of a row,");
      if (own.isMatrix) { addDots(own); explainEmpty(own); }
      byId("metric").append(page.element("option", { value: own.metric }, table.closest("details").querySelector("summary").textContent));
    }
    byId("matrix-controls").hidden = tables.size === 0;
    if (!tables.size) return;
    byId("metric").addEventListener("change", () => { page.setState({ metric: byId("metric").value }, true); show(byId("metric").value); });
    byId("filter").addEventListener("input", () => { page.setState({ filter: byId("filter").value }); draw(); });
    for (const button of byId("matrix-controls").querySelectorAll("[data-copy]")) button.addEventListener("click", () => copy(button.dataset.copy));
    page.onState(() => { byId("filter").value = page.stateOf("filter") || ""; show(page.stateOf("metric")); });
    show(null);
  };
})(window.stillpoint);
