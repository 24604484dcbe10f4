// SPDX-License-Identifier: BSD-3-Clause
// Shared by the page tests: a browser that records requests, warnings and errors, and checks for any page.
import assert from "node:assert/strict";
import { chromium } from "playwright-core";

export const launch = (...flags) => chromium.launch({ executablePath: process.env.BROWSER, args: ["--no-sandbox", ...flags] });
export const browser = await launch();

export async function test(name, action) {
  await action();
  console.log("ok  " + name);
}

export const ready = (page) => page.waitForFunction(() => document.documentElement.dataset.readyMs !== undefined, null, { timeout: 10000 })
  .catch(() => assert.fail("not ready: " + page.problems.join("; ")));

// Opens a file. Requests other than the file itself are recorded as problems unless `isAllowed` accepts them.
// options.browser: another one than `browser`. Chromium without a GPU warns of the speed of WebGL.
export async function open(file, { browser: other = browser, ...options } = {}, isAllowed = () => false, hash = "") {
  const page = await other.newPage({ viewport: { width: 1400, height: 900 }, ...options });
  page.problems = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type()) && !/GPU stall due to ReadPixels/.test(message.text())) page.problems.push(message.text()); });
  page.on("pageerror", (error) => page.problems.push(error.message));
  page.on("dialog", (dialog) => { page.problems.push("dialog " + dialog.message()); dialog.dismiss(); });
  page.on("request", (request) => {
    if (request.url().split("#")[0] !== "file://" + file && !isAllowed(request) && !/^(data|blob):/.test(request.url())) page.problems.push("request " + request.url());
  });
  await page.goto("file://" + file + hash);
  await ready(page);
  return page;
}

// The data attributes of a section after the next redraw: selected run, frame, zoom etc.
export const selection = (page, section) => page.evaluate(async (id) => {
  for (let i = 0; i < 2; ++i) await new Promise((drawn) => requestAnimationFrame(drawn));
  return { ...document.getElementById(id).dataset };
}, section);

// Names of the charts below a selector, after checking that none is blank.
export async function drawnCharts(page, selector) {
  const charts = await page.$$eval(selector + " figure", (figures) => figures.map((figure) => {
    const canvas = figure.querySelector("canvas");
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const colors = new Set();
    for (let i = 0; i < pixels.length; i += 4) if (pixels[i + 3] > 200) colors.add((pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2]);
    return [figure.dataset.chart, colors.size];
  }));
  for (const [name, colors] of charts) assert.ok(colors > 3, name + " is blank");
  return charts.map((chart) => chart[0]);
}

export async function lightAndDarkDiffer(page) {
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await background();
  await page.click("#theme");
  assert.notEqual(await background(), light);
  await page.click("#theme");
}

// On a phone: nothing is wider than the window, texts have contrast in both themes, the keyboard reaches all controls.
export async function phoneSuffices(page) {
  assert.equal(await page.evaluate(() => innerWidth), 390);
  for (let i = 0; i < 2; ++i) {
    assert.deepEqual(await page.evaluate(() => [document.documentElement.scrollWidth - innerWidth, ...[...document.querySelectorAll(".table")].filter((part) => part.scrollWidth > part.clientWidth + 1).map((part) => part.parentElement.textContent.slice(0, 60))]), [0], "wider than a phone");
    await page.click("#theme");
  }
  await contrastSuffices(page);
  await keyboardSuffices(page);
}

// Checks the contrast of all texts in both themes (WCAG 2.1, level AA, without the exception for large text).
export async function contrastSuffices(page) {
  for (let i = 0; i < 2; ++i) {
    const low = await page.evaluate(() => {
      const context = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
      const channels = (colors) => { context.clearRect(0, 0, 1, 1); for (const color of colors) { context.fillStyle = color; context.fillRect(0, 0, 1, 1); } return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3); };
      const luminance = (colors) => channels(colors).map((value) => value / 255).map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4)).reduce((sum, value, c) => sum + value * [0.2126, 0.7152, 0.0722][c], 0);
      const found = new Set();
      for (const element of document.querySelectorAll("body *")) {
        if (!element.checkVisibility() || element.closest("svg, canvas") || ![...element.childNodes].some((node) => node.nodeType === 3 && node.data.trim())) continue;
        const grounds = [];
        for (let at = element; at; at = at.parentElement) grounds.unshift(getComputedStyle(at).backgroundColor);
        const [a, b] = [luminance(grounds), luminance([...grounds, getComputedStyle(element).color])].toSorted();
        const contrast = (b + 0.05) / (a + 0.05);
        if (contrast < 4.5) found.add(`${element.tagName}.${element.className} ${contrast.toFixed(2)}`);
      }
      return [...found];
    });
    assert.deepEqual(low, []);
    await page.click("#theme");
  }
}

// Checks that Tab reaches every visible control, and that each shows that it has the focus.
export async function keyboardSuffices(page) {
  const count = await page.evaluate(() => {
    const controls = [...document.querySelectorAll("a[href], button, select, input, textarea, summary, [tabindex='0']")].filter((element) => element.checkVisibility() && !element.disabled);
    window.focused = new Map();
    document.activeElement.blur();
    scrollTo(0, 0);
    document.addEventListener("focusin", (event) => window.focused.set(event.target, getComputedStyle(event.target).outlineStyle !== "none"));
    window.controls = controls;
    return controls.length;
  });
  for (let i = 0; i < count + 5; ++i) await page.keyboard.press("Tab");
  const name = "((element) => element.outerHTML.slice(0, 80))";
  assert.deepEqual(await page.evaluate(`window.controls.filter((element) => !window.focused.has(element)).map(${name})`), [], "not reached by Tab");
  assert.deepEqual(await page.evaluate(`[...window.focused].filter(([, visible]) => !visible).map(([element]) => ${name}(element))`), [], "without a visible focus");
}
