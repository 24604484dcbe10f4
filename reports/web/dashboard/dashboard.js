// SPDX-License-Identifier: BSD-3-Clause
// History view: one subject at a time, with its accuracy and cost in one chart and one chart per metric.
"use strict";
(function (page) {
  const { commits, plans, hosts, subjects, series, shifts, preferred, tooltips } = page.index;
  const byId = (id) => document.getElementById(id);
  const state = { subject: -1, commit: null, charts: null, open: -1, moving: false };

  const seriesOf = (subject) => series.map((one, i) => i).filter((i) => series[i].subject === subject);
  const shownSubjects = () => {
    const plan = byId("plan").value, host = byId("host").value;
    return subjects.map((_, i) => i).filter((i) => (plan === "" || subjects[i].plans.includes(Number(plan))) && (host === "" || subjects[i].host === Number(host)));
  };

  function fill(list, entries, wanted) {
    list.replaceChildren(...entries.map(([value, text]) => page.element("option", { value }, text)));
    if (entries.some(([value]) => String(value) === String(wanted))) list.value = wanted;
  }

  // Subjects with equal labels differ in machine or data, which are appended then.
  function subjectText(i) {
    const same = subjects.filter((other) => other.label === subjects[i].label);
    if (same.length === 1) return subjects[i].label;
    const data = same.some((other) => other.data !== subjects[i].data) ? ", data " + subjects[i].data.slice(0, 8) : "";
    const host = same.some((other) => other.host !== subjects[i].host) ? ", " + hosts[subjects[i].host] : "";
    return subjects[i].label + data + host;
  }

  // Values at the selected commit, by default the newest. The layout is the same at every commit, so that the charts
  // below do not move under the pointer.
  function readout() {
    const place = byId("readout");
    place.replaceChildren();
    const shown = state.commit === null ? commits.length - 1 : state.commit, commit = commits[shown];
    const add = (label, text) => { const part = page.element("span", { title: tooltips[label] || "" }); part.append(page.element("b", {}, label + " "), text); place.append(part); };
    add("commit", page.element("a", { href: commit.page }, commit.label));
    add("time", commit.time);
    if (commits.some((one) => one.subject)) add("subject", commit.subject || "-");
    for (const index of seriesOf(state.subject)) {
      if (series[index].family === "other") continue;
      const at = series[index].commits.indexOf(shown), runs = series[index].runs[at];
      const text = at < 0 ? "-" : Number(series[index].values[at].toPrecision(4)) + (series[index].unit ? " " + series[index].unit : "");
      add(series[index].metric, text + (runs > 1 ? ", " + runs + " runs" : ""));
    }
  }

  function point(commit, fromChart) {
    if (state.moving) return;
    state.moving = true;
    state.commit = commit;
    readout();
    if (!fromChart) state.charts.point(commit);
    byId("history").dataset.commit = commits[commit].name;
    state.moving = false;
  }

  const open = (commit) => { location.href = commits[commit].page; };

  // The selected metric of a family, or the first one available for the subject. @return index of its series
  function chosen(family) {
    const list = byId(family), own = seriesOf(state.subject).filter((i) => series[i].family === family);
    const names = own.map((i) => series[i].metric);
    const wanted = [list.value, ...preferred[family]].find((name) => names.includes(name)) || names[0];
    fill(list, own.map((i) => [series[i].metric, series[i].metric]), wanted);
    return own.find((i) => series[i].metric === wanted);
  }

  function draw() {
    if (state.charts) state.charts.destroy();
    byId("timeline").replaceChildren();
    byId("metric-charts").replaceChildren();
    const accuracy = chosen("accuracy"), cost = chosen("cost");
    const lines = [];
    if (accuracy !== undefined) lines.push({ index: accuracy, scale: "accuracy", color: "c0" });
    if (cost !== undefined) lines.push({ index: cost, scale: "cost", color: "c2" });
    const groups = [{ place: byId("timeline"), id: "timeline", title: "Accuracy and cost over commits", lines, height: 260 }];
    for (const index of seriesOf(state.subject)) {
      const unit = series[index].unit ? " [" + series[index].unit + "]" : "";
      groups.push({ place: byId("metric-charts"), id: series[index].metric, title: series[index].metric + unit, height: 130, lines: [{ index, scale: "y", color: series[index].family === "cost" ? "c2" : "c0" }] });
    }
    state.charts = page.drawHistory(groups, (commit) => point(commit, true), open, (min, max) => { byId("history").dataset.zoom = min.toFixed(2) + " " + max.toFixed(2); });
    // Cursor positions are defined only after the first draw.
    requestAnimationFrame(() => { if (state.commit !== null) state.charts.point(state.commit); });
  }

  page.showSubject = function (subject) {
    state.subject = subject;
    byId("subject").value = subject;
    byId("history").dataset.subject = subjects[subject].label;
    draw();
    readout();
  };

  // Shows the subject of a series and highlights its chart.
  page.showSeries = function (index) {
    const subject = series[index].subject;
    byId("plan").value = "";
    byId("host").value = "";
    listSubjects(subject);
    const family = series[index].family;
    if (family !== "other") { chosen(family); byId(family).value = series[index].metric; draw(); }
    byId("history").dataset.series = index;
    const figure = [...byId("metric-charts").children].find((child) => child.dataset.chart === series[index].metric);
    if (figure) figure.classList.add("selected");
    byId("history").scrollIntoView();
  };

  function listSubjects(wanted) {
    const shown = shownSubjects();
    fill(byId("subject"), shown.map((i) => [i, subjectText(i)]), wanted);
    if (shown.length) page.showSubject(Number(byId("subject").value));
  }

  function stepSubject(by) {
    const shown = shownSubjects();
    if (shown.length) page.showSubject(shown[(shown.indexOf(state.subject) + by + shown.length) % shown.length]);
  }

  function stepCommit(by) {
    const from = state.commit === null ? (by > 0 ? -1 : commits.length) : state.commit;
    point(Math.max(0, Math.min(commits.length - 1, from + by)), false);
  }

  function nextRegression() {
    const all = shifts.filter((shift) => shift.state === "open");
    if (!all.length) return;
    state.open = (state.open + 1) % all.length;
    state.commit = all[state.open].after;
    page.showSeries(all[state.open].series);
    point(state.commit, true);
  }

  const KEYS = {
    ArrowRight: (event) => stepCommit(event.shiftKey ? 10 : 1), ArrowLeft: (event) => stepCommit(event.shiftKey ? -10 : -1),
    n: () => stepSubject(1), p: () => stepSubject(-1), r: nextRegression, 0: () => state.charts.resetZoom(),
    "+": () => state.charts.zoomBy(0.5, state.commit), "-": () => state.charts.zoomBy(2, state.commit),
    Enter: () => { if (state.commit !== null) open(state.commit); },
  };

  function onKey(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || /^(SELECT|INPUT|TEXTAREA)$/.test(event.target.tagName)) return;
    if (event.key === "Enter" && /^(A|BUTTON|SUMMARY)$/.test(event.target.tagName)) return;
    const action = KEYS[event.key];
    if (!action) return;
    event.preventDefault();
    action(event);
  }

  function fromHash() {
    const match = /^#series=(\d+)$/.exec(location.hash);
    if (!match || Number(match[1]) >= series.length) return false;
    page.showSeries(Number(match[1]));
    return true;
  }

  function toggleTheme() {
    const root = document.documentElement;
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
    draw();
  }

  // The subject of the first open regression, else the one with the most measurements.
  function firstSubject() {
    const regressed = shifts.find((shift) => shift.state === "open");
    if (regressed) return series[regressed.series].subject;
    return series.reduce((most, one) => (one.commits.length > most.commits.length ? one : most)).subject;
  }

  fill(byId("plan"), [["", "all"], ...plans.map((name, i) => [i, name])], "");
  fill(byId("host"), [["", "all"], ...hosts.map((name, i) => [i, name])], "");
  for (const id of ["plan", "host"]) byId(id).addEventListener("change", () => listSubjects(state.subject));
  for (const id of ["accuracy", "cost"]) byId(id).addEventListener("change", draw);
  byId("subject").addEventListener("change", () => page.showSubject(Number(byId("subject").value)));
  byId("previous").addEventListener("click", () => stepSubject(-1));
  byId("next").addEventListener("click", () => stepSubject(1));
  byId("regression").addEventListener("click", nextRegression);
  byId("reset-zoom").addEventListener("click", () => state.charts.resetZoom());
  byId("theme").addEventListener("click", toggleTheme);
  document.addEventListener("keydown", onKey);
  window.addEventListener("hashchange", fromHash);
  window.addEventListener("resize", () => state.charts.resize());
  page.stackTables(document);
  if (!fromHash()) listSubjects(firstSubject());
  document.documentElement.dataset.readyMs = Math.round(performance.now());
})(window.stillpoint);
