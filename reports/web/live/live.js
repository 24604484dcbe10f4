// SPDX-License-Identifier: BSD-3-Clause
// Progress of a store while a bench executes plans into it: each message of the server is the whole state.
"use strict";
(function (page) {
  const { columns, events } = page.index;
  const byId = (id) => document.getElementById(id);
  const runs = (count) => count + (count === 1 ? " run" : " runs");

  function duration(seconds) {
    const s = Math.round(seconds), m = Math.round(seconds / 60);
    return s < 120 ? s + " s" : m < 120 ? m + " min" : Math.floor(m / 60) + " h " + (m % 60) + " min";
  }

  function planText(plan) {
    const parts = [`${plan.ended} of ${runs(plan.runs)}`];
    if (plan.failed) parts.push(plan.failed + " failed");
    if (plan.per_s !== null) parts.push(Number((60 * plan.per_s).toPrecision(3)) + " runs per minute");
    if (plan.ended < plan.runs && plan.left_s !== null) parts.push(duration(plan.left_s) + " left");
    if (plan.ended < plan.runs && !plan.executed) parts.push("not being executed");
    return parts.join(", ");
  }

  function planView(plan) {
    const view = page.element("div", { class: "plan" }), text = planText(plan);
    view.append(page.element("b", {}, plan.title || plan.name), page.element("progress", { max: Math.max(plan.runs, 1), value: plan.ended, "aria-label": plan.name }),
      page.element("span", {}, text));
    return view;
  }

  function runRow(run) {
    const row = page.element("tr");
    row.dataset.key = run.key;
    row.append(page.element("th", { scope: "row" }, run.label),
      page.element("td", { class: run.outcome === "ok" ? "" : "failed", title: run.detail }, run.outcome === "ok" ? "ok" : run.outcome + (run.detail ? ": " + run.detail : "")),
      ...run.values.map((value, i) => page.element("td", {}, value === null ? "n/a" : value.toFixed(columns[i].decimals))),
      page.element("td", {}, run.ended));
    return row;
  }

  function show(state) {
    const executed = state.plans.find((plan) => plan.executed);
    document.title = (executed ? `${executed.ended}/${executed.runs} ` : "") + "Stillpoint: runs of a store";
    byId("workers").textContent = state.workers ? (state.workers === 1 ? "One worker is" : state.workers + " workers are") + " alive." : "No worker is alive on this machine.";
    byId("pages").replaceChildren(...(state.pages ? ["With ", runs(state.pages), " of ", runs(state.ended), ": ", page.element("a", { href: "report/" }, "report"), ", ", page.element("a", { href: "dashboard/" }, "dashboard"), "."] : ["No run has ended."]));
    byId("plans").replaceChildren(...(state.plans.length ? state.plans.map(planView) : [page.element("p", { class: "none" }, "The store has no plan.")]));
    byId("running").replaceChildren(...(state.running.length ? state.running.map((run) => page.element("li", {}, run.label + ", since " + duration(run.seconds))) : [page.element("li", { class: "none" }, "none")]));
    byId("newest").tBodies[0].replaceChildren(...state.runs.map(runRow));
    page.stackTables(document);
    document.documentElement.dataset.messages = Number(document.documentElement.dataset.messages || 0) + 1;
  }

  function toggleTheme() {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
  }

  const head = page.element("tr");
  for (const text of ["run", "result", ...columns.map((column) => column.label + (column.unit ? " " + column.unit : "")), "ended (UTC)"]) head.append(page.element("th", { scope: "col" }, text));
  byId("newest").tHead.append(head);
  byId("theme").addEventListener("click", toggleTheme);
  const source = new EventSource(events);
  source.addEventListener("message", (event) => show(JSON.parse(event.data)));
  source.addEventListener("error", () => { byId("workers").textContent = "The server does not answer; what follows is its last message. Trying again."; });
  document.documentElement.dataset.readyMs = Math.round(performance.now());
})(window.stillpoint);
