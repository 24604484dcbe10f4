// SPDX-License-Identifier: BSD-3-Clause
// Shared by the page tests: a browser that records requests, warnings and errors, and checks for any page.
import assert from "node:assert/strict";
import { chromium } from "playwright-core";

export const browser = await chromium.launch({ executablePath: process.env.BROWSER, args: ["--no-sandbox"] });

export async function test(name, action) {
  await action();
  console.log("ok  " + name);
}

export const ready = (page) => page.waitForFunction(() => document.documentElement.dataset.readyMs !== undefined, null, { timeout: 10000 })
  .catch(() => assert.fail("not ready: " + page.problems.join("; ")));

// Opens a file. Requests other than the file itself are recorded as problems unless `isAllowed` accepts them.
export async function open(file, options = {}, isAllowed = () => false, hash = "") {
  const page = await browser.newPage({ viewport: { width: 1300, height: 900 }, ...options });
  page.problems = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) page.problems.push(message.text()); });
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
