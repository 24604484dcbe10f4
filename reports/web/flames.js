// SPDX-License-Identifier: BSD-3-Clause
// Time per frame of a variant from its folded stacks, as a flame chart and as a table.
"use strict";
(function (page) {
  const byId = (id) => document.getElementById(id);

  // {"outer;inner": ns} -> tree with values in ms per frame.
  function treeOf(flame) {
    const root = { name: "frame", value: 0, children: [] };
    for (const [stack, ns] of Object.entries(flame.stacks)) {
      const ms = ns / 1e6 / Math.max(flame.frames, 1);
      let node = root;
      node.value += ms;
      for (const name of stack.split(";")) {
        let child = node.children.find((candidate) => candidate.name === name);
        if (!child) node.children.push((child = { name, value: 0, children: [] }));
        child.value += ms;
        node = child;
      }
    }
    return root;
  }

  const label = (node) => node.data.name + ": " + node.data.value.toPrecision(3) + " ms";

  function tableOf(flame) {
    const table = page.element("table");
    const head = page.element("tr");
    for (const title of ["stack", "self time per frame [ms]"]) head.append(page.element("th", { scope: "col" }, title));
    table.append(head);
    for (const [stack, ns] of Object.entries(flame.stacks).sort((a, b) => b[1] - a[1])) {
      const row = page.element("tr");
      row.append(page.element("th", { scope: "row" }, stack.split(";").join(" > ")), page.element("td", {}, (ns / 1e6 / Math.max(flame.frames, 1)).toFixed(4)));
      table.append(row);
    }
    return table;
  }

  function draw(flame) {
    const place = byId("flame"), tree = treeOf(flame);
    place.replaceChildren();
    const chart = d3flame.flamegraph().width(place.clientWidth || 900).cellHeight(20).inverted(true).transitionDuration(0).tooltip(false)
      .selfValue(false).setLabelHandler(label).setColorMapper((node) => `color-mix(in srgb, ${page.color("c" + ((node.depth + node.data.name.length) % page.LINE_COLORS))} 40%, ${page.color("background")})`);
    d3flame.select(place).datum(tree).call(chart);
    place.setAttribute("aria-label", "Flame chart of " + flame.label + ": " + tree.value.toPrecision(3) + " ms per frame");
    byId("flame-text").textContent = tree.value.toPrecision(3) + " ms per frame, mean over " + flame.frames + " frames";
    byId("flame-table").replaceChildren(tableOf(flame));
    byId("flames").dataset.variant = flame.label;
  }

  page.redrawFlames = () => { if (page.index.flames.length) draw(page.index.flames[Number(byId("flame-variant").value)]); };

  page.startFlames = function () {
    const flames = page.index.flames, list = byId("flame-variant");
    byId("flames").hidden = !flames.length;
    if (!flames.length) return;
    flames.forEach((flame, i) => list.append(page.element("option", { value: i }, flame.label)));
    list.addEventListener("change", page.redrawFlames);
    let width = byId("flame").clientWidth;
    window.addEventListener("resize", () => { if (width !== byId("flame").clientWidth) { width = byId("flame").clientWidth; page.redrawFlames(); } });
    page.redrawFlames();
  };
})(window.stillpoint);
