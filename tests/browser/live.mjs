// SPDX-License-Identifier: BSD-3-Clause
// Tests of `serve --watch` while a bench executes a plan. Run by pages.sh.
//   URL=http://... node live.mjs
import assert from "node:assert/strict";
import { browser, contrastSuffices, keyboardSuffices, test } from "./browser.mjs";

const { URL: ADDRESS } = process.env;
const page = await browser.newPage({ viewport: { width: 390, height: 844 } });
const problems = [], loads = [];
page.on("console", (message) => { if (["error", "warning"].includes(message.type())) problems.push(message.text()); });
page.on("pageerror", (error) => problems.push(error.message));
page.on("request", (request) => loads.push(request.url().slice(ADDRESS.length)));
await page.goto(ADDRESS);

const messages = (at) => page.waitForFunction((count) => Number(document.documentElement.dataset.messages) >= count, at, { timeout: 600000 });
const state = () => page.evaluate(() => ({
  ended: document.querySelector("#plans progress")?.value, total: document.querySelector("#plans progress")?.max, text: document.querySelector("#plans span")?.textContent ?? "",
  running: [...document.querySelectorAll("#running li:not(.none)")].map((item) => item.textContent), runs: [...document.querySelectorAll("#newest tbody tr")].map((row) => row.dataset.key),
  workers: document.getElementById("workers").textContent, pages: document.getElementById("pages").textContent, title: document.title }));

await test("the page shows the plan, the worker and the running runs while the bench goes on", async () => {
  await page.waitForFunction(() => document.querySelector("#running li:not(.none)"), null, { timeout: 600000 });
  const now = await state();
  assert.equal(now.total, 8);
  assert.ok(now.ended < now.total, now.text);
  assert.match(now.workers, /^One worker is alive\.$/);
  assert.match(now.running[0], /^\S+ on \S+.*, seed 1, since \d+ s$/);
  assert.match(now.title, /^\d\/8 /);
});

const seen = [];
await test("runs appear without a reload, with rate and remaining time", async () => {
  for (;;) {
    const now = await state();
    for (const key of now.runs.toReversed()) if (!seen.includes(key)) seen.push(key);
    if (now.runs.length >= 2 && now.ended < now.total) {
      assert.equal(now.runs.length, now.ended);
      assert.match(now.text, /^\d of 8 runs, [\d.e+]+ runs per minute, \d+ (s|min) left$/);
      break;
    }
    assert.ok(now.ended !== now.total, "the bench ended before two runs were seen");
    await messages(1 + Number(await page.evaluate(() => document.documentElement.dataset.messages)));
  }
});

await test("at the end all runs are listed, the newest first, and report and dashboard contain them", async () => {
  await page.waitForFunction(() => /^No worker/.test(document.getElementById("workers").textContent) && /^With 8 runs of 8/.test(document.getElementById("pages").textContent), null, { timeout: 600000 });
  const now = await state();
  assert.equal(now.runs.length, 8);
  assert.deepEqual(now.runs.toReversed().slice(0, seen.length), seen, "runs that were seen keep their place");
  assert.match(now.text, /^8 of 8 runs$/);
  for (const width of [1400, 390]) {
    await page.setViewportSize({ width, height: 844 });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "wider than " + width);
  }
  assert.deepEqual(loads, ["", "events"]);
  await contrastSuffices(page);
  await keyboardSuffices(page);
  for (const link of ["report", "dashboard"]) {
    const opened = await browser.newPage();
    assert.equal((await opened.goto(ADDRESS + link + "/")).status(), 200);
    await opened.waitForFunction(() => document.documentElement.dataset.readyMs !== undefined);
    if (link === "report") assert.equal(await opened.locator("#run option").count(), 8);
    await opened.close();
  }
});

await test("the served report loads the data of a run when it is selected or compared", async () => {
  const opened = await browser.newPage(), files = [], problems = [];
  opened.on("request", (request) => { const file = /report\/(runs\/.*)/.exec(request.url()); if (file) files.push(file[1]); });
  opened.on("console", (message) => { if (["error", "warning"].includes(message.type())) problems.push(message.text()); });
  opened.on("pageerror", (error) => problems.push(error.message));
  const bytes = (await (await opened.goto(ADDRESS + "report/")).body()).length;
  const shown = (key) => opened.waitForFunction((key) => document.getElementById("runs").dataset.run === key, key, { timeout: 5000 });
  const keys = await opened.evaluate(() => window.stillpoint.index.runs.map((run) => run.key));
  await shown(keys[0]);
  assert.deepEqual(files, [`runs/${keys[0]}.json`]);
  await opened.keyboard.press("n");
  await shown(keys[1]);
  await opened.keyboard.press("p");
  await shown(keys[0]);
  assert.deepEqual(files, keys.slice(0, 2).map((key) => `runs/${key}.json`), "a file is loaded once");
  const all = await opened.evaluate(() => { const { index, series } = window.stillpoint; return [series(0).t.length, index.runs[0].frames, series(0).numbers]; });
  assert.deepEqual(all, [all[1], all[1], null], "all frames of the run");
  await opened.locator(`#table-ate_rmse_m a[data-runs~="${keys[2]}"]`).click();
  await opened.waitForFunction((key) => document.getElementById("compare").dataset.runs === key, keys[2], { timeout: 5000 });
  assert.equal(files.length, 3);
  assert.ok(await opened.evaluate(() => document.getElementById("series-0") === null));
  console.log(`    page of ${keys.length} runs: ${(bytes / 1e3).toFixed(0)} kB`);
  const again = await browser.newPage();
  await again.goto(opened.url());
  await again.waitForFunction((key) => document.getElementById("compare").dataset.runs === key, keys[2], { timeout: 5000 });
  await again.close();
  await opened.route("**/runs/*.json", (route) => route.fulfill({ status: 404, body: "" }));
  await opened.evaluate(() => window.stillpoint.selectRun(5));
  await opened.waitForFunction(() => /cannot be loaded \(404/.test(document.getElementById("load-problem").textContent), null, { timeout: 5000 });
  assert.deepEqual(problems.filter((text) => !/404/.test(text)), []);
  await opened.close();
});

await test("the page says when the server is gone", async () => {
  process.kill(Number(process.env.SERVER), "SIGTERM");
  await page.waitForFunction(() => /does not answer/.test(document.getElementById("workers").textContent), null, { timeout: 5000 });
  assert.deepEqual(problems.filter((text) => !/ERR_CONNECTION_REFUSED|ERR_INCOMPLETE_CHUNKED/.test(text)), []);
});

await browser.close();
