// SPDX-License-Identifier: BSD-3-Clause
// Tests of the report page. Run by pages.sh.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { browser, contrastSuffices, drawnCharts, keyboardSuffices, launch, lightAndDarkDiffer, open, phoneSuffices, selection, test } from "./browser.mjs";

const { PAGE, WORK, STILLPOINT_SCREENSHOTS } = process.env;

const runs = (page) => selection(page, "runs");
const page = await open(PAGE);

await test("every chart has data", async () => {
  assert.deepEqual(await drawnCharts(page, "#series"), ["error", "features", "dynamic", "modules"]);
});

await test("hovering one chart moves the cursor of all charts and shows the frame", async () => {
  const over = page.locator("[data-chart=error] .u-over");
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  await page.mouse.move(box.x + box.width * 0.3, box.y + box.height / 2, { steps: 5 });
  const first = Number((await runs(page)).frame);
  await page.mouse.move(box.x + box.width * 0.6, box.y + box.height / 2, { steps: 5 });
  const second = Number((await runs(page)).frame);
  assert.ok(second > first, `frame ${first}, then ${second}`);
  assert.match(await page.textContent("#readout"), new RegExp("frame " + second));
  const cursors = await page.$$eval("#series .u-cursor-x", (lines) => lines.map((line) => line.style.transform));
  assert.equal(new Set(cursors).size, 1);
});

await test("the results are a matrix with a dot per run, sorted, filtered, and copied in three formats", async () => {
  const rows = () => page.$$eval("#table-ate_rmse_m tbody tr", (lines) => lines.map((line) => [...line.cells].map((cell) => (cell.querySelector("a[data-runs]") || cell).textContent)));
  const before = await rows();
  const dots = await page.$$eval("#table-ate_rmse_m td", (cells) => cells.map((cell) => [cell.querySelectorAll("circle, .failed").length, (cell.querySelector("a[data-runs]")?.dataset.runs ?? "").split(" ").filter((key) => key).length]));
  for (const [drawn, runs] of dots) assert.equal(drawn, runs);
  const single = await page.$$eval("#table-ate_rmse_m td", (cells) => cells.filter((cell) => cell.querySelectorAll("circle").length === 1).map((cell) => [cell.querySelector("circle").getAttribute("cx"), cell.querySelector(".median").getAttribute("x1")]));
  assert.ok(single.length > 0);
  for (const [dot, median] of single) assert.equal(median, dot, "the median of one run is that run");
  for (const direction of [1, -1]) {
    await page.locator("#table-ate_rmse_m .sort").first().press("Enter");
    const numbers = (await rows()).map((row) => direction * parseFloat(row[1])).filter(Number.isFinite);
    assert.deepEqual(numbers, numbers.toSorted((a, b) => a - b));
  }
  await page.fill("#filter", before[0][0].toUpperCase());
  const shown = await rows();
  assert.ok(shown.length > 0 && shown.length < before.length && shown.every((row) => row[0].includes(before[0][0])));
  for (const [format, expected] of [["CSV", /^[^,\n]+,/], ["Markdown", /^\| .* \|\n\| --- \| ---: \|/], ["LaTeX", /^\\begin\{tabular\}\{lr+\}\n\\toprule/]]) {
    await page.click(`[data-copy=${format}]`);
    const text = await page.inputValue("#copied");
    assert.match(text, expected);
    assert.ok(text.includes(shown[0][1]), text);
  }
  await page.fill("#filter", "");
  assert.equal((await rows()).length, before.length);
});

await test("sequences of the matrix are chosen, its numbers have counts and intervals, and only metrics with data are offered", async () => {
  const names = () => page.$$eval("#table-ate_rmse_m", ([table]) => [...table.rows].flatMap((row) => row.cells[0].textContent).concat([...table.tHead.rows[0].cells].map((cell) => cell.textContent)));
  const all = await names(), boxes = page.locator("#column-list input");
  await page.locator("#columns summary").press("Enter");
  const out = await boxes.first().getAttribute("value");
  await boxes.first().press("Space");
  assert.ok(all.includes(out) && !(await names()).includes(out), out + " is still shown");
  await page.click("[data-copy=CSV]");
  assert.ok(!new RegExp(`(^|,)${out}(,|$)`, "m").test(await page.inputValue("#copied")), "copied as it is shown");
  const other = await open(PAGE, { viewport: { width: 390, height: 844 } }, undefined, new URL(page.url()).hash);
  assert.equal(await other.locator("#column-list input:not(:checked)").getAttribute("value"), out);
  await other.close();
  await boxes.first().press("Space");
  assert.deepEqual(await names(), all);
  const text = () => page.textContent("#table-ate_rmse_m tbody");
  const before = await text();
  await page.locator("#spread").press("Space");
  assert.match(await text(), /n = \d/);
  await page.locator("#spread").press("Space");
  assert.equal(await text(), before);
  for (const metric of await page.$$eval("#metric option", (options) => options.map((option) => option.value))) {
    await page.selectOption("#metric", metric);
    assert.match(await page.textContent(`#table-${metric} tbody`), /\d/, metric + " has no number");
  }
  await page.selectOption("#metric", "ate_rmse_m");
});

await test("runs of a cell and others are compared: paths, errors, status, faults, numbers, differences, frames at one time", async () => {
  const keys = await page.evaluate(() => {
    const { index } = window.stillpoint;
    const of = (label, blank) => index.runs.find((run) => run.label.startsWith(label) && run.sequence.includes("walking_xyz") && run.sequence.includes("blank") === blank && !run.sweep);
    return [of("stillpoint", true), of("vo", false)].map((run) => run.key);
  });
  await page.evaluate(() => document.querySelector("#table-ate_rmse_m a[data-runs]").scrollIntoView());
  await page.locator(`#table-ate_rmse_m a[data-runs~="${keys[0]}"]`).click();
  await page.locator(`#table-ate_rmse_m a[data-runs~="${keys[1]}"]`).click({ modifiers: ["Shift"] });
  const compared = async () => (await selection(page, "compare")).runs.split(".");
  assert.deepEqual((await compared()).toSorted(), keys.toSorted());
  assert.match(await page.textContent("#compare-source"), /^Source of .* Protocol: /);
  assert.equal(await page.locator("#compare-error .u-series").count(), 3);
  assert.ok(await page.locator("#compare-status .fault").count() === 1 && await page.locator("#compare-status .bar").count() === 2);
  const initializing = await page.$eval("#compare-status .initializing", (part) => getComputedStyle(part).backgroundColor);
  assert.notEqual(initializing, await page.evaluate(() => { const part = document.createElement("span"); part.className = "status lost"; document.body.append(part); const color = getComputedStyle(part).backgroundColor; part.remove(); return color; }));
  assert.ok(await page.locator("#compare-metrics tbody tr").count() > 5);
  await page.locator("#compare-differences").press("Enter");
  assert.match(await page.textContent("#compare-config"), /imu\.enabled/);
  const colors = await page.$eval("#compare-path", (canvas) => new Set(new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size);
  assert.ok(colors > 4, colors + " colors in the plan");
  await page.locator("#compare-time").focus();
  await page.keyboard.press("Home");
  const frames = () => page.$$eval("#compare-frames img", (images) => images.map((image) => image.alt));
  const first = await frames();
  await page.keyboard.press("End");
  assert.notDeepEqual(await frames(), first);
  assert.match(await page.textContent("#compare-at"), /^[23]\.\d\d s$/);
});

await test("a run is added and removed, counters and times per module are listed, and numbers have their definitions", async () => {
  const compared = async () => (await selection(page, "compare")).runs.split("."), before = await compared();
  const other = await page.evaluate((keys) => window.stillpoint.index.runs.findIndex((run) => !keys.includes(run.key)), before);
  await page.selectOption("#compare-add", String(other));
  assert.equal((await compared()).length, before.length + 1);
  await page.locator("#compared button").last().press("Enter");
  assert.deepEqual(await compared(), before);
  await page.locator("#compare summary", { hasText: "Time per module" }).press("Enter");
  assert.match(await page.textContent("#compare-modules tbody"), /feature_tracking \[ms\][\d.]+/);
  assert.match(await page.textContent("#compare-metrics tbody"), /resets/);
  const undefined_ = await page.$$eval("#compare-metrics tbody th, #results details:not([hidden]) dt", (names) => names.filter((name) => !name.title && name.tagName === "TH").map((name) => name.textContent));
  assert.deepEqual(undefined_, [], "metrics without a definition");
});

await test("the reason of a missing value is shown to the keyboard, and ticks of small errors differ", async () => {
  const missing = page.locator("#compare-metrics abbr").first();
  assert.equal(await missing.textContent(), "n/a");
  await missing.focus();
  assert.match(await missing.evaluate((part) => getComputedStyle(part, "::after").content), /the run has no value of this metric/);
  const ticks = await page.evaluate(() => window.stillpoint.axes("m")[1].values(null, [0, 0.0005, 0.001, 0.1 + 0.2]));
  assert.deepEqual(ticks, ["0", "0.0005", "0.001", "0.3"]);
});

await test("the legend hides and shows a line by keyboard", async () => {
  const entry = page.locator("#compare-error .u-series").nth(1), head = entry.locator("th");
  const state = async () => [await head.getAttribute("aria-pressed"), await entry.evaluate((row) => row.classList.contains("u-off"))];
  assert.deepEqual(await state(), ["true", false]);
  await head.press("Enter");
  assert.deepEqual(await state(), ["false", true]);
  await head.press(" ");
  assert.deepEqual(await state(), ["true", false]);
  await head.click();
  assert.deepEqual(await state(), ["false", true]);
  await head.click();
});

// Colors of the 3-D view, which is drawn for that: WebGL does not keep what it has shown.
const sceneColors = async (page) => new Map(await page.evaluate(() => {
  window.stillpoint.redrawCompare();
  const gl = document.getElementById("compare-scene").getContext("webgl2"), { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
  const pixels = new Uint8Array(4 * width * height), counts = new Map();
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  for (const color of new Uint32Array(pixels.buffer)) counts.set(color, (counts.get(color) || 0) + 1);
  return [...counts];
}));
const eyeOf = (page) => page.evaluate(() => window.stillpoint.stateOf("eye"));
const sceneIsShown = (page) => page.waitForFunction(() => !document.getElementById("compare-scene").hidden);

await test("paths are shown in 3-D with cameras and error colors, by keyboard and mouse", async () => {
  assert.equal(await page.evaluate(() => typeof THREE), "undefined", "decoded before it is used");
  await page.selectOption("#compare-view", "3d");
  await sceneIsShown(page);
  const withCameras = await sceneColors(page);
  assert.ok(withCameras.size > 20, withCameras.size + " colors");
  await page.getByLabel("cameras").uncheck();
  const background = (counts) => Math.max(...counts.values());
  const bare = await sceneColors(page);
  assert.ok(background(bare) > background(withCameras), "fewer pixels are drawn without cameras");
  await page.getByLabel("landmarks").uncheck();
  assert.ok(background(await sceneColors(page)) > background(bare), "fewer pixels are drawn without landmarks");
  await page.getByLabel("color by error").check();
  const byError = await sceneColors(page), known = new Set(bare.keys());
  assert.ok([...byError.keys()].filter((color) => !known.has(color)).length > 20, "colors of the error");
  assert.match(await page.textContent("#path-caption"), /squares of [\d.]+ m; .*error 0 to [\d.]+ m/);
  const frame = (await runs(page)).frame, eyes = [];
  await page.locator("#compare-scene").focus();
  for (const key of ["ArrowLeft", "Shift+ArrowUp", "+", "0"]) { await page.keyboard.press(key); eyes.push(await eyeOf(page)); }
  assert.equal(new Set(eyes).size, 4);
  const distance = (eye) => { const at = eye.split(" ").map(Number); return Math.hypot(at[0] - at[3], at[1] - at[4], at[2] - at[5]); };
  assert.ok(distance(eyes[2]) < 0.9 * distance(eyes[1]), "+ goes nearer");
  await page.keyboard.press("-");
  assert.ok(distance(await eyeOf(page)) > 1.1 * distance(eyes[3]), "- goes away");
  await page.keyboard.press("0");
  assert.equal((await runs(page)).frame, frame, "the keys of the scene select no frame");
  const canvas = page.locator("#compare-scene"), time = () => page.textContent("#compare-at");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox(), middle = [box.x + box.width / 2, box.y + box.height / 2];
  // A press outside of the canvas that ends in it.
  await canvas.evaluate((element) => element.dispatchEvent(new PointerEvent("pointerup", { button: 0 })));
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0] + 60, middle[1] + 10, { steps: 3 });
  await page.mouse.up();
  assert.notEqual(await eyeOf(page), eyes[3], "turned by dragging");
  const before = await time();
  for (let part = 0.1; part < 1 && await time() === before; part += 0.02) {
    const place = [box.x + box.width * part, box.y + box.height / 2];
    await page.mouse.click(...place, { button: "right" });
    assert.equal(await time(), before, "the right button selects no time");
    await page.mouse.click(...place);
  }
  assert.notEqual(await time(), before, "a click on a path selects its time");
});

await test("a path of 150,000 frames is colored by error, and in its own color where the error is unknown", async () => {
  const [largest, color] = await page.evaluate(async () => {
    const count = 150000, points = [0, 1, ...Array(count - 2).fill(null)], error = [null, null, ...Array(count - 2).fill(0.5)];
    const scene = await window.stillpoint.pathScene(document.createElement("canvas"), () => {}, () => {});
    const path = { x: points, y: points, z: points, t: points, q: null, error, color: "#ff0000", dash: [], width: 1 };
    const most = scene.show([path], new Set(["error"]), [1, 1, 1, 0, 0, 0]);
    const line = scene.content.children.find(({ geometry }) => geometry.attributes.instanceColorStart);
    return [most, [...line.geometry.attributes.instanceColorStart.array.slice(0, 3)]];
  });
  assert.equal(largest, 0.5);
  assert.deepEqual(color, [1, 0, 0]);
});

await test("without WebGL the top view is shown, and why", async () => {
  const other = await launch("--disable-3d-apis");
  const opened = await open(PAGE, { browser: other }, undefined, new URL(page.url()).hash);
  await opened.waitForFunction(() => document.getElementById("scene-problem").textContent !== "");
  assert.match(await opened.textContent("#scene-problem"), /no WebGL: the top view is shown/);
  assert.equal(await opened.inputValue("#compare-view"), "plan");
  assert.ok(await opened.locator("#compare-path").isVisible() && !await opened.locator("#compare-scene").isVisible());
  assert.deepEqual(opened.problems, []);
  await other.close();
});

// The run with loops in 3-D; on the page of a phone and in a theme of choice by the address only.
await test("static surfaces and loops are shown in 3-D in both themes, also on a phone, and kept by the address", async () => {
  const before = new URL(page.url()).hash, run = await page.evaluate(() => window.stillpoint.index.runs.findIndex((one) => one.label.includes("loop")));
  const series = await page.evaluate((i) => { window.stillpoint.compareRuns([i]); const { loops, surfaces } = window.stillpoint.series(i); return { loops: loops.map((loop) => loop.reason), points: surfaces.x.length }; }, run);
  assert.ok(series.loops.includes("") && series.points > 500, JSON.stringify(series));
  const box = (page, layer) => page.locator(`#scene-options [value=${layer}]`);
  const drawnPixels = async (page) => { const counts = [...(await sceneColors(page)).values()]; return counts.reduce((sum, count) => sum + count, 0) - Math.max(...counts); };
  const layersAreDrawn = async (page) => {
    const click = (selector) => page.evaluate((selected) => document.querySelector(selected).click(), selector);
    for (let theme = 0; theme < 2; ++theme) {
      let drawn = await drawnPixels(page);
      for (const layer of ["surfaces", "loops"]) {
        await click(`#scene-options [value=${layer}]`);
        const rest = await drawnPixels(page);
        assert.ok(rest < drawn - 20, layer + " are not drawn");
        drawn = rest;
      }
      for (const selector of ["#scene-options [value=surfaces]", "#scene-options [value=loops]", "#theme"]) await click(selector);
    }
  };
  for (const layer of ["surfaces", "loops"]) if (!await box(page, layer).isChecked()) await box(page, layer).press("Space");
  await page.locator("#compare-scene").press("0");
  await layersAreDrawn(page);
  await box(page, "cameras").uncheck();
  const other = await open(PAGE, { viewport: { width: 390, height: 844 } }, undefined, new URL(page.url()).hash);
  await sceneIsShown(other);
  const shown = (page) => page.$$eval("#scene-options input", (boxes) => boxes.map((box) => [box.value, box.checked, box.parentElement.hidden]));
  assert.deepEqual(await shown(other), await shown(page));
  assert.match(await other.textContent("#path-caption"), /loops: solid accepted, dashed refused; .*static surfaces/);
  await layersAreDrawn(other);
  const split = await other.$$eval("#scene-options label:not([hidden])", (labels) => labels.filter((label) => label.getClientRects().length > 1 || label.clientHeight > 30).map((label) => label.textContent));
  assert.deepEqual(split, [], "boxes apart from their names");
  assert.deepEqual(await other.$$eval("#compare-readout > span", (parts) => parts.filter((part) => part.scrollWidth > part.clientWidth).map((part) => part.textContent)), [], "cut");
  await other.evaluate((i) => { const series = window.stillpoint.series(i); series.surfaces = null; series.loops = []; window.stillpoint.redrawCompare(); }, run);
  assert.ok(!await box(other, "surfaces").isVisible() && !await box(other, "loops").isVisible(), "a switch without data");
  assert.deepEqual(other.problems, []);
  await other.close();
  await page.evaluate((hash) => { location.hash = hash; }, before);
});

await test("the meaning of colors is below the paths, no value is cut, and charts are legible on a phone", async () => {
  const loops = await page.evaluate(() => window.stillpoint.index.runs.find((run) => run.label.includes("loop")).key);
  for (const [width, colorScheme] of [[1400, "light"], [390, "dark"]]) {
    const opened = await open(PAGE, { viewport: { width, height: 844 }, colorScheme }, undefined, "#run=" + loops);
    for (const caption of await opened.locator("#paths figcaption").all())
      assert.match(await caption.textContent(), /error 0 to [\d.]+ m; gray: ground truth, red: tracking lost; loops: solid accepted, dashed refused$/);
    const cut = await opened.$$eval("#readout > span", (parts) => parts.filter((part) => part.lastElementChild.scrollWidth > part.lastElementChild.clientWidth || part.lastElementChild.getBoundingClientRect().right > part.getBoundingClientRect().right + 1).map((part) => part.textContent));
    assert.deepEqual(cut, []);
    assert.ok(await opened.$$eval("#worst-list button", (buttons) => buttons.every((button) => button.offsetHeight < 30)), "a worst frame in two lines");
    assert.ok(await opened.$$eval(".wide svg", (charts) => charts.length > 0 && charts.every((chart) => chart.clientWidth >= 700)));
    await opened.close();
  }
});

await test("the address holds the state of the page", async () => {
  await page.click("#theme");
  await page.selectOption("#metric", "coverage");
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("ArrowRight");
  const state = (page) => page.evaluate(() => ({ view: document.getElementById("compare-view").value, shows: [...document.querySelectorAll("#scene-options :checked")].map((box) => box.value), ...document.getElementById("runs").dataset, compared: document.getElementById("compare").dataset.runs, time: document.getElementById("compare-at").textContent,
    theme: document.documentElement.dataset.theme, metric: document.getElementById("metric").value, sorted: document.querySelector("#table-coverage [aria-sort]:not([aria-sort=none])")?.textContent }));
  await selection(page, "runs");
  const before = await state(page);
  const other = await open(PAGE, { viewport: { width: 390, height: 844 } }, undefined, new URL(page.url()).hash);
  await selection(other, "runs");
  await sceneIsShown(other);
  assert.deepEqual(await state(other), before);
  assert.equal(await eyeOf(other), await eyeOf(page));
  assert.ok(before.theme && before.compared && before.frame && before.metric === "coverage" && before.view === "3d" && await eyeOf(page));
  await phoneSuffices(other);
  await other.close();
  await page.goBack();
  assert.equal(await page.inputValue("#metric"), "ate_rmse_m");
  await page.click("#compare-clear");
  assert.equal(await page.locator("#compare-views").isVisible(), false);
  await page.click("#theme");
});

await test("text has a contrast of 4.5 in both themes", () => contrastSuffices(page));

await test("the keyboard reaches every control, with a visible focus, and zooms", async () => {
  await keyboardSuffices(page);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("0");
  const span = async () => { const [low, high] = (await runs(page)).zoom.split(" ").map(Number); return high - low; };
  const whole = await span();
  await page.keyboard.press("+");
  assert.ok(Math.abs(await span() - whole / 2) < 0.01, "half of the time");
  await page.keyboard.press("-");
  assert.ok(Math.abs(await span() - whole) < 0.01, "all of it");
  const [first, second] = await page.$$eval("#table-ate_rmse_m a[data-runs]", (links) => links.map((link) => link.dataset.runs));
  await page.locator("#table-ate_rmse_m a[data-runs]").nth(0).press("Enter");
  await page.locator("#table-ate_rmse_m a[data-runs]").nth(1).press("Shift+Enter");
  assert.equal((await selection(page, "compare")).runs, [first, second].join(" ").replaceAll(" ", "."));
});

await test("the error has a band of three claimed standard deviations, and faults a bar", async () => {
  const fault = await page.evaluate(() => {
    const { index, series, selectRun } = window.stillpoint;
    selectRun(index.runs.findIndex((run) => run.sequence.includes("blank")));
    return series(window.stillpoint.selectedRun()).faults[0];
  });
  assert.deepEqual([fault.begin, fault.end], [1.5, 2]);
  assert.match(await page.textContent("[data-chart=error] .u-legend"), /3 sigma, claimed/);
  const bar = await page.evaluate(() => {
    const canvas = document.querySelector("[data-chart=error] canvas"), over = document.querySelector("[data-chart=error] .u-over");
    const left = parseFloat(over.style.left), width = parseFloat(over.style.width), top = parseFloat(over.style.top);
    const times = window.stillpoint.series(window.stillpoint.selectedRun()).t;
    const row = canvas.getContext("2d").getImageData(left * devicePixelRatio, (top + 2) * devicePixelRatio, width * devicePixelRatio, 1).data;
    const pixel = (t) => { const i = 4 * Math.round(row.length / 4 * t / times.at(-1)); return row.slice(i, i + 4).join(); };
    return [pixel(1.75), pixel(1)];
  });
  assert.notEqual(bar[0], bar[1], "the color during the fault and before it");
  for (let i = 0; i < 6; ++i) await page.keyboard.press("Shift+ArrowRight");
  assert.match(await page.textContent("#readout"), /fault blank:.*3 sigma, claimed \[m\]/);
  await page.evaluate(() => window.stillpoint.selectRun(0));
});

await test("hovering the path selects a frame", async () => {
  const canvas = page.locator("#path-plan");
  await canvas.scrollIntoViewIfNeeded();
  const at = await page.evaluate(() => {
    const pixels = (canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const canvas = document.getElementById("path-plan"), data = pixels(canvas);
    for (let y = 40; y < canvas.height - 40; ++y) for (let x = 40; x < canvas.width - 40; ++x) {
      const i = 4 * (y * canvas.width + x);
      if (data[i + 3] > 250 && Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 60) return { x: x / devicePixelRatio, y: y / devicePixelRatio };
    }
  });
  await page.evaluate(() => { document.getElementById("runs").dataset.frame = ""; });
  await canvas.hover({ position: at });
  assert.notEqual((await runs(page)).frame, "");
});

await test("dragging zooms all charts, and 0 resets the zoom", async () => {
  const over = page.locator("[data-chart=features] .u-over");
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  await page.mouse.move(box.x + box.width * 0.25, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.5, box.y + 40, { steps: 5 });
  await page.mouse.up();
  const [low, high] = (await runs(page)).zoom.split(" ").map(Number);
  assert.ok(low > 0 && high > low);
  await page.keyboard.press("0");
  const [start] = (await runs(page)).zoom.split(" ").map(Number);
  assert.equal(start, 0);
});

await test("keys step through frames, worst frames and runs", async () => {
  const before = Number((await runs(page)).frame);
  await page.keyboard.press("ArrowRight");
  assert.equal(Number((await runs(page)).frame), before + 1);
  await page.keyboard.press("Shift+ArrowLeft");
  assert.equal(Number((await runs(page)).frame), Math.max(0, before - 9));
  await page.keyboard.press("w");
  const worst = Number((await runs(page)).frame);
  await page.keyboard.press("w");
  assert.notEqual(Number((await runs(page)).frame), worst);
  const run = (await runs(page)).run;
  await page.keyboard.press("n");
  assert.notEqual((await runs(page)).run, run);
  await page.keyboard.press("p");
  assert.equal((await runs(page)).run, run);
});

await test("keys step through annotated images of the worst frames", async () => {
  const shown = () => page.$eval("#frame-image", async (image) => { await image.decode(); return [image.naturalWidth, image.src.length, image.alt]; });
  await page.evaluate(() => window.stillpoint.redrawExplorer());
  const ranks = [];
  for (const key of ["w", "w", "W"]) {
    await page.keyboard.press(key);
    const [width, bytes, alt] = await shown();
    assert.ok(width >= 320 && bytes > 4000, `${width} px, ${bytes} bytes`);
    ranks.push(Number(/, (\d+) of the/.exec(alt)[1]));
    assert.equal((await runs(page)).image, (await runs(page)).frame);
  }
  assert.deepEqual(ranks, [1, 2, 1]);
  assert.equal(await page.locator("#worst-list button").count(), 20);
  await page.locator("#worst-list button").nth(2).press("Enter");
  assert.match(await page.textContent("#frame-caption"), /, 3 of the 20 worst/);
});

await test("the flame chart has entries, zooms on click and changes with the variant", async () => {
  const widths = () => page.$$eval("#flame rect", (rects) => rects.map((rect) => Number(rect.getAttribute("width"))));
  const initial = await widths();
  assert.ok(initial.length > 5, initial.length + " entries");
  await page.locator("#flame g").filter({ hasText: "optimization" }).first().click();
  // d3 redraws asynchronously after the click.
  await page.waitForFunction((before) => JSON.stringify([...document.querySelectorAll("#flame rect")].map((rect) => Number(rect.getAttribute("width")))) !== before, JSON.stringify(initial));
  const first = await page.getAttribute("#flames", "data-variant");
  await page.selectOption("#flame-variant", { index: 1 });
  assert.notEqual(await page.getAttribute("#flames", "data-variant"), first);
  assert.ok(await page.locator("#flame-table tr").count() > 5);
});

await test("each module of the run has a histogram", async () => {
  const bars = await page.$$eval("#histograms figure", (figures) => figures.map((figure) => [figure.dataset.module, [...figure.querySelectorAll("rect")].filter((rect) => Number(rect.getAttribute("height")) > 0).length]));
  assert.ok(bars.some(([name]) => name === "feature_tracking"));
  for (const [name, count] of bars) assert.ok(count > 1, name);
});

await test("relative pose errors have a curve, and OpenLORIS scenes have their figure", async () => {
  assert.ok(await page.locator("#segment-curves canvas").count() > 0);
  const scenes = await page.evaluate(() => window.stillpoint.index.runs.some((run) => /^(market|corridor)/.test(run.sequence)));
  assert.equal(await page.locator("figure.openloris svg circle").count() > 0, scenes);
});

await test("a number in a table links to its run", async () => {
  const link = page.locator("#table-ate_rmse_m td a").last();
  const key = (await link.getAttribute("href")).slice("#run=".length);
  await link.click();
  await page.waitForFunction((wanted) => document.getElementById("runs").dataset.run === wanted, key);
  assert.equal(await page.locator(`#compared a[href="#run=${key}"]`).count(), 1);
  assert.match(await page.textContent("#repeat-run"), /^stillpoint bench '\w+\.toml' --filter '[^']+' --filter '\w+( \+ [^']+)?' --store/);
});

await test("tables and series can be downloaded", async () => {
  for (const name of ["ate_rmse_m.csv", "series of the selected run.csv"]) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name, exact: true }).click()]);
    const text = readFileSync(await download.path(), "utf8");
    assert.ok(text.split("\n").length > 2, name);
  }
});

await test("sweeps have a curve", async () => {
  const swept = await page.evaluate(() => window.stillpoint.index.runs.some((run) => run.sweep));
  assert.equal(await page.locator("#sweeps").isVisible(), swept);
  assert.equal(await page.locator("#curves canvas").count() > 0, swept);
});

await test("the theme button switches between light and dark", () => lightAndDarkDiffer(page));

await test("no network requests, warnings or errors occurred", () => assert.deepEqual(page.problems, []));

// Those of reports/figures.
if (STILLPOINT_SCREENSHOTS) {
  const light = await open(PAGE, { colorScheme: "light", viewport: { width: 1200, height: 1500 } });
  await light.evaluate(() => window.stillpoint.selectRun(Math.max(0, window.stillpoint.index.runs.findIndex((run) => run.sequence === "walking_xyz"))));
  await light.keyboard.press("w");
  await light.screenshot({ path: `${STILLPOINT_SCREENSHOTS}/report_light.png` });
  await light.close();
  const dark = await open(PAGE, { colorScheme: "dark", viewport: { width: 1200, height: 1050 } });
  await dark.evaluate(() => {
    const { runs } = window.stillpoint.index, of = (label) => runs.findIndex((run) => run.label === label && run.sequence.startsWith("walking_xyz + blank"));
    window.stillpoint.compareRuns([of("stillpoint"), of("vo")]);
  });
  await dark.selectOption("#compare-view", "3d");
  await sceneIsShown(dark);
  await dark.locator("#compare-time").press("End");
  await dark.locator("#compare-scene").press("-");
  await dark.locator("#compare-scene").press("-");
  await dark.evaluate(() => { document.activeElement.blur(); document.getElementById("compare").scrollIntoView(); });
  await dark.screenshot({ path: `${STILLPOINT_SCREENSHOTS}/report_compare_dark.png` });
  await dark.close();
}

// The page with `count` runs of 1,000 frames each, replicated from its first run.
function grown(text, count) {
  const script = (id) => new RegExp(`(<script type="application/json" id="${id}">)(.*?)(</script>)`, "s");
  const index = JSON.parse(script("index").exec(text)[2]);
  const one = index.runs.findIndex((run) => run.frames > 0);
  const series = JSON.parse(script("series-" + one).exec(text)[2]);
  const frames = 1000;
  const bytes = (packed) => { const source = Buffer.from(packed.data, "base64"); return Buffer.alloc(2 * frames, source).toString("base64"); };
  const ramp = Buffer.from(Uint16Array.from({ length: frames }, (_, i) => i).buffer).toString("base64");
  series.frames = frames;
  series.t = { low: 0, step: 1 / 30, data: ramp };
  for (const column of Object.values(series.columns)) column.data = bytes(column);
  const runs = Array.from({ length: count }, (_, i) => ({ ...index.runs[one], key: i.toString(16), frames }));
  const all = runs.map((_, i) => `<script type="application/json" id="series-${i}">${JSON.stringify(series)}</script>`).join("\n");
  const bare = text.replace(/<script type="application\/json" id="(series|images)-\d+">.*?<\/script>/gs, "");
  return bare.replace(script("index"), (_, open, __, close) => open + JSON.stringify({ ...index, runs }) + close + "\n" + all);
}

// The page with markup in all names that the scripts read.
function hostile(text) {
  const name = "<img src=x onerror='window.broken=1'>\"'&\u202e\\{}%$" + "long ".repeat(200);
  return text.replace(/(<script type="application\/json" id="index">)(.*?)(<\/script>)/s, (_, open, json, close) => {
    const index = JSON.parse(json);
    for (const run of index.runs) Object.assign(run, { label: name, sequence: name, build: name, detail: name });
    for (const flame of index.flames) { flame.label = name; flame.stacks = { ...flame.stacks, [name + ";" + name]: 5e9 }; }
    for (const figure of index.segments) { figure.sequence = name; for (const curve of figure.curves) curve.label = name; }
    return open + JSON.stringify(index).replaceAll("<", "\\u003c") + close;
  });
}

await test("hostile names are shown as text and do not widen the page", async () => {
  const file = WORK + "/hostile.html";
  writeFileSync(file, hostile(readFileSync(PAGE, "utf8")));
  const opened = await open(file);
  for (const key of ["n", "w"]) await opened.keyboard.press(key);
  await opened.locator("#table-ate_rmse_m td a").last().click();
  assert.equal(await opened.locator("img:not(#frame-image, [src^='data:image/jpeg;'])").count(), 0);
  assert.equal(await opened.evaluate(() => window.broken), undefined);
  assert.ok(await opened.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "wider than the window");
  assert.deepEqual(opened.problems, []);
  await opened.close();
});

// Times of one session are compared: what is fast depends on the machine and on what else it does.
await test("the time to open grows at most in proportion to the runs", async () => {
  const least = { 100: Infinity, 1000: Infinity };
  for (let i = 0; i < 3; ++i) for (const count of [100, 1000]) {
    const file = WORK + `/${count}.html`;
    writeFileSync(file, grown(readFileSync(PAGE, "utf8"), count));
    const opened = await open(file);
    least[count] = Math.min(least[count], Number(await opened.evaluate(() => document.documentElement.dataset.readyMs)));
    assert.equal(await opened.locator("#run option").count(), count);
    await opened.close();
  }
  console.log(`    100 runs of 1,000 frames are open after ${least[100]} ms, 1,000 after ${least[1000]} ms`);
  assert.ok(least[1000] < 10 * least[100]);
});

await browser.close();
