// SPDX-License-Identifier: BSD-3-Clause
// Tests of `serve --watch` while a bench executes a plan. Run by pages.sh.
//   URL=http://... node live.mjs
import assert from "node:assert/strict";
import { browser, test } from "./browser.mjs";

const { URL: ADDRESS } = process.env;
const page = await browser.newPage({ viewport: { width: 390, height: 844 } });
const problems = [], loads = [];
page.on("console", (message) => { if (["error", "warning"].includes(message.type())) problems.push(message.text()); });
page.on("pageerror", (error) => problems.push(error.message));
page.on("request", (request) => loads.push(request.url().slice(ADDRESS.length)));
await page.goto(ADDRESS);

const messages = (at) => page.waitForFunction((count) => Number(document.documentElement.dataset.messages) >= count, at, { timeout: 60000 });
const state = () => page.evaluate(() => ({
  ended: document.querySelector("#plans progress")?.value, total: document.querySelector("#plans progress")?.max, text: document.querySelector("#plans span")?.textContent ?? "",
  running: [...document.querySelectorAll("#running li:not(.none)")].map((item) => item.textContent), runs: [...document.querySelectorAll("#newest tbody tr")].map((row) => row.dataset.key),
  workers: document.getElementById("workers").textContent, pages: document.getElementById("pages").textContent, title: document.title }));

await test("the page shows the plan, the worker and the running runs while the bench goes on", async () => {
  await page.waitForFunction(() => document.querySelector("#running li:not(.none)"), null, { timeout: 60000 });
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
      assert.match(now.text, /^\d of 8 runs, [\d.e+]+ runs per minute, \d+ s left$/);
      break;
    }
    assert.ok(now.ended !== now.total, "the bench ended before two runs were seen");
    await messages(1 + Number(await page.evaluate(() => document.documentElement.dataset.messages)));
  }
});

await test("at the end all runs are listed, the newest first, and report and dashboard contain them", async () => {
  await page.waitForFunction(() => /^No worker/.test(document.getElementById("workers").textContent) && /^With 8 runs of 8/.test(document.getElementById("pages").textContent), null, { timeout: 60000 });
  const now = await state();
  assert.equal(now.runs.length, 8);
  assert.deepEqual(now.runs.toReversed().slice(0, seen.length), seen, "runs that were seen keep their place");
  assert.match(now.text, /^8 of 8 runs$/);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "wider than a phone");
  assert.deepEqual(loads, ["", "events"]);
  for (const link of ["report", "dashboard"]) {
    const opened = await browser.newPage();
    assert.equal((await opened.goto(ADDRESS + link + "/")).status(), 200);
    await opened.waitForFunction(() => document.documentElement.dataset.readyMs !== undefined);
    if (link === "report") assert.equal(await opened.locator("#run option").count(), 8);
    await opened.close();
  }
});

await test("the page says when the server is gone", async () => {
  process.kill(Number(process.env.SERVER), "SIGTERM");
  await page.waitForFunction(() => /does not answer/.test(document.getElementById("workers").textContent), null, { timeout: 5000 });
  assert.deepEqual(problems.filter((text) => !/ERR_CONNECTION_REFUSED|ERR_INCOMPLETE_CHUNKED/.test(text)), []);
});

await browser.close();
