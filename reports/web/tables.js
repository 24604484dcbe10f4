// SPDX-License-Identifier: BSD-3-Clause
// Tables in narrow windows: each cell is labeled with the heading of its column.
"use strict";
(function (page) {
  // Headings of the columns; those of two rows are joined.
  function headings(table) {
    const lines = [];
    [...table.tHead.rows].forEach((row, y) => {
      let x = 0;
      for (const cell of row.cells) {
        while (lines[x] !== undefined && lines[x].until > y) ++x;
        for (let i = 0; i < cell.colSpan; ++i, ++x)
          lines[x] = { text: ((lines[x] ? lines[x].text + ": " : "") + cell.textContent).replace(/^: /, ""), until: y + cell.rowSpan };
      }
    });
    return lines.map((line) => line.text);
  }

  // Labels the cells of all tables below `place` that have one head.
  page.stackTables = function (place) {
    for (const table of place.querySelectorAll(".table > table")) {
      table.classList.add("stacked");
      if (!table.tHead) continue;
      const names = headings(table);
      for (const row of table.tBodies[0].rows) {
        [...row.cells].forEach((cell, i) => { if (cell.tagName === "TD") cell.dataset.label = names[i] || ""; });
      }
    }
  };
})(window.stillpoint);
