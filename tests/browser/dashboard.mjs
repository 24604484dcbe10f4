// SPDX-License-Identifier: BSD-3-Clause
// Tests of the dashboard page. Run by dashboard.sh with the store of history_store.mjs.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { browser, contrastSuffices, drawnCharts, keyboardSuffices, lightAndDarkDiffer, open, phoneSuffices, ready, selection, test } from "./browser.mjs";

const { PAGE, STILLPOINT_SCREENSHOTS } = process.env;
const folder = "file://" + PAGE.slice(0, PAGE.lastIndexOf("/") + 1);

// Navigation between the pages of the dashboard is allowed.
const openDashboard = (options) => open(PAGE, options, (request) => request.isNavigationRequest() && request.url().startsWith(folder));
const shown = (page) => selection(page, "history");
const page = await openDashboard();

await test("the page is small apart from its data", async () => {
  const ms = Number(await page.evaluate(() => document.documentElement.dataset.readyMs));
  const data = await page.evaluate(() => document.getElementById("index").textContent.length);
  console.log(`    open after ${ms} ms; ${((statSync(PAGE).size - data) / 1e3).toFixed(0)} kB without its data`);
  assert.ok(statSync(PAGE).size - data < 400e3);
});

await test("every chart has data, and accuracy and cost share one chart", async () => {
  const charts = await drawnCharts(page, "#history");
  assert.equal(charts[0], "timeline");
  assert.deepEqual(charts.slice(1).sort(),
    ["ate_rmse_m", "coverage", "failed_runs", "feature_tracking", "process_cpu_s", "resets", "state_optimization"]);
  assert.deepEqual(await page.$$eval("#timeline .u-legend .u-label", (labels) => labels.map((label) => label.textContent)), ["commit", "ate_rmse_m", "process_cpu_s"]);
});

await test("the known regression is listed as open with its commits, and the accepted change with its reason", async () => {
  const row = page.locator("#open-changes tr", { hasText: "state_optimization" });
  const commits = await page.evaluate(() => window.stillpoint.index.commits.map((commit) => commit.label));
  const text = await row.textContent();
  assert.ok(text.includes(`${commits[39]} .. ${commits[40]}`), text);
  assert.match(await page.locator("#accepted-changes").textContent(), /a faster solver <b>"worth" it<\/b>/);
  assert.match(await page.locator("#drifts").textContent(), /ate_rmse_m.*worse/s);
  assert.equal(await page.locator("#open-changes tr", { hasText: "ate_rmse_m" }).count(), 0);
});

await test("the first line says what changed and what cannot be seen; a regression has the command that accepts it", async () => {
  const first = await page.textContent(".summary li");
  assert.match(first, /^2 open regressions, first state_optimization of stillpoint on walking_xyz: \+\d.* 60 commits: steps of more than \d+ % in accuracy and \d+ % in cost could be seen, smaller ones not\.$/);
  const row = page.locator("#open-changes tr", { hasText: "state_optimization" });
  await row.locator("summary", { hasText: "accept" }).press("Enter");
  const commit = await page.evaluate(() => window.stillpoint.index.commits[40].name);
  assert.equal(await row.locator("code").textContent(), `stillpoint store accept '${commit}' --metric 'state_optimization' --reason 'WHY' --store STORE`);
  const phone = await openDashboard({ viewport: { width: 390, height: 844 } });
  await phoneSuffices(phone);
  await phone.close();
});

await test("a suspected change is listed with its p-value, one click away from the runs before and after, and its chart has an address", async () => {
  const row = page.locator("#suspected tbody tr", { hasText: "stillpoint on market" });
  assert.match(await row.textContent(), /^ate_rmse_m.*38 \+ 20\.0\d+worse$/s);
  const links = await row.locator("a[href*='commits/']").evaluateAll((all) => all.map((link) => link.textContent));
  assert.deepEqual(links, await page.evaluate(() => window.stillpoint.index.commits.slice(57, 59).map((commit) => commit.label)));
  await row.locator("a[href^='#series=']").press("Enter");
  assert.equal((await shown(page)).subject, "stillpoint on market");
  const address = page.url(), again = await openDashboard({ viewport: { width: 390, height: 844 } });
  await again.goto(address);
  await again.reload();
  await ready(again);
  assert.equal((await shown(again)).subject, "stillpoint on market");
  await again.close();
  await page.goBack();
});

await test("hovering one chart moves the cursor of all charts and shows the commit", async () => {
  const over = page.locator("#timeline .u-over");
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  await page.mouse.move(box.x + box.width * 0.3, box.y + box.height / 2, { steps: 5 });
  const first = (await shown(page)).commit;
  await page.mouse.move(box.x + box.width * 0.6, box.y + box.height / 2, { steps: 5 });
  assert.notEqual((await shown(page)).commit, first);
  assert.match(await page.textContent("#readout"), /commit .*ate_rmse_m/s);
  const cursors = await page.$$eval("#metric-charts .u-cursor-x", (lines) => lines.map((line) => line.style.transform));
  assert.equal(new Set(cursors).size, 1, cursors.join(" "));
});

await test("dragging zooms all charts, and 0 shows all commits", async () => {
  const over = page.locator("#timeline .u-over");
  const box = await over.boundingBox();
  await page.mouse.move(box.x + box.width * 0.25, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.5, box.y + 40, { steps: 5 });
  await page.mouse.up();
  const [low, high] = (await shown(page)).zoom.split(" ").map(Number);
  assert.ok(low > 5 && high < 40, `${low} to ${high}`);
  await page.keyboard.press("0");
  assert.deepEqual((await shown(page)).zoom, "-0.50 59.50");
});

await test("keys step through commits, subjects and open regressions", async () => {
  await page.mouse.move(2, 2);
  const at = (page) => shown(page).then((state) => page.evaluate((name) => window.stillpoint.index.commits.findIndex((commit) => commit.name === name), state.commit));
  const before = await at(page);
  await page.keyboard.press("ArrowRight");
  assert.equal(await at(page), before + 1);
  await page.keyboard.press("Shift+ArrowLeft");
  assert.equal(await at(page), before - 9);
  const subject = (await shown(page)).subject;
  await page.keyboard.press("n");
  assert.notEqual((await shown(page)).subject, subject);
  await page.keyboard.press("p");
  assert.equal((await shown(page)).subject, subject);
  await page.keyboard.press("r");
  assert.equal((await shown(page)).subject, "stillpoint on walking_xyz");
  assert.equal(await at(page), 40);
});

await test("plan and machine filter the subjects", async () => {
  const subjects = () => page.$$eval("#subject option", (options) => options.map((option) => option.textContent));
  await page.selectOption("#plan", "0");
  assert.deepEqual(await subjects(), ["vo on walking_xyz, Desktop, 2 processors"]);
  await page.selectOption("#plan", "");
  const small = await page.evaluate(() => window.stillpoint.index.hosts.findIndex((host) => host.startsWith("Small device")));
  await page.selectOption("#host", String(small));
  assert.deepEqual(await subjects(), ["vo on walking_xyz, Small device, 2 processors"]);
  await page.selectOption("#host", "");
  assert.equal((await subjects()).length, 5);
});

await test("Enter opens the commit's page with its change points and differences", async () => {
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("r");
  const target = (await shown(page)).commit;
  await page.keyboard.press("Enter");
  await page.waitForSelector("#shifts");
  assert.match(await page.textContent("h1"), new RegExp(target));
  assert.match(await page.textContent("#shifts"), /state_optimization.*open|process_cpu_s.*open/s);
  assert.ok(await page.locator("#metric-table tbody tr").count() > 4);
  await page.locator("#shifts a").first().click();
  await ready(page);
  assert.notEqual((await shown(page)).series, undefined);
});

await test("hostile names are shown as text", async () => {
  const at = await page.evaluate(() => window.stillpoint.index.subjects.findIndex((subject) => subject.label.includes("onerror")));
  await page.evaluate((subject) => window.stillpoint.showSubject(subject), at);
  assert.match((await shown(page)).subject, /"><img src=x onerror=alert\(1\)>/);
  assert.equal(await page.locator("img").count(), 0);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(wide <= 0, `${wide} px wider than the window`);
  const link = await page.evaluate(() => window.stillpoint.index.commits[5].page);
  await page.goto(folder + link);
  assert.match(await page.textContent("h1"), /onerror=alert/);
  assert.equal(await page.locator("img").count(), 0);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= document.documentElement.clientWidth));
  await page.goBack();
  await ready(page);
});

await test("the theme button switches between light and dark", () => lightAndDarkDiffer(page));

await test("text has a contrast of 4.5 in both themes", () => contrastSuffices(page));

await test("the keyboard reaches every control, with a visible focus, and zooms", async () => {
  await keyboardSuffices(page);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("0");
  const whole = (await shown(page)).zoom;
  await page.keyboard.press("+");
  const [low, high] = (await shown(page)).zoom.split(" ").map(Number);
  assert.ok(Math.abs(high - low - 30) < 0.1, `${low} to ${high}`);
  await page.keyboard.press("-");
  await page.keyboard.press("-");
  assert.equal((await shown(page)).zoom, whole);
});

await test("no network requests, warnings or errors occurred", () => assert.deepEqual(page.problems, []));

if (STILLPOINT_SCREENSHOTS) {
  for (const colorScheme of ["light", "dark"]) {
    const opened = await openDashboard({ colorScheme, viewport: { width: 1200, height: 1500 } });
    await opened.keyboard.press("r");
    await opened.evaluate(() => scrollTo(0, 0));
    await opened.screenshot({ path: `${STILLPOINT_SCREENSHOTS}/dashboard_${colorScheme}.png` });
    await opened.keyboard.press("Enter");
    await opened.waitForSelector("#shifts");
    await opened.screenshot({ path: `${STILLPOINT_SCREENSHOTS}/dashboard_commit_${colorScheme}.png` });
    await opened.close();
  }
}

await browser.close();
