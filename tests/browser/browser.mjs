// SPDX-License-Identifier: BSD-3-Clause
// What the tests of pages share: a browser whose every request and complaint is kept, and checks of any page.
import assert from "node:assert/strict";
import { chromium } from "playwright-core";

export const browser = await chromium.launch({ executablePath: process.env.BROWSER, args: ["--no-sandbox"] });

export async function test(name, action) {
  await action();
  console.log("ok  " + name);
}

export const ready = (page) => page.waitForFunction(() => document.documentElement.dataset.readyMs !== undefined, null, { timeout: 10000 })
  .catch(() => assert.fail("not ready: " + page.faults.join("; ")));

// A page of a file. Only `isOwn` requests, beside the file itself, are no faults.
export async function open(file, options = {}, isOwn = () => false) {
  const page = await browser.newPage({ viewport: { width: 1300, height: 900 }, ...options });
  page.faults = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) page.faults.push(message.text()); });
  page.on("pageerror", (error) => page.faults.push(error.message));
  page.on("dialog", (dialog) => { page.faults.push("dialog " + dialog.message()); dialog.dismiss(); });
  page.on("request", (request) => {
    if (request.url() !== "file://" + file && !isOwn(request) && !/^(data|blob):/.test(request.url())) page.faults.push("request " + request.url());
  });
  await page.goto("file://" + file);
  await ready(page);
  return page;
}

// What a page's section points at, after it has drawn.
export const pointedAt = (page, section) => page.evaluate(async (id) => {
  for (let i = 0; i < 2; ++i) await new Promise((drawn) => requestAnimationFrame(drawn));
  return { ...document.getElementById(id).dataset };
}, section);

// Names of the charts below a selector; none of them is blank.
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
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await ground();
  await page.click("#theme");
  assert.notEqual(await ground(), light);
  await page.click("#theme");
}
