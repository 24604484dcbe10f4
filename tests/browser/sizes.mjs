// SPDX-License-Identifier: BSD-3-Clause
// Large stores and the times to open their pages. Run by sizes.sh.
//   node sizes.mjs runs EXPORT FIRST LAST FILE   runs FIRST to LAST - 1 of a minute, made of those of 3 s of an export
//   node sizes.mjs history FILE                  10,200 runs of 34 subjects over 300 commits
//   node sizes.mjs open URL...                   times of 5 visits
import { closeSync, openSync, readFileSync, writeSync } from "node:fs";

const [mode, ...rest] = process.argv.slice(2);
const FRAMES = 90, SECONDS = 3, TILES = 20;

// Pseudo-random generator with a fixed seed, uniform in -0.5 .. 0.5.
let state = 7;
const random = () => { state = (Math.imul(state, 1664525) + 1013904223) >>> 0; return state / 4294967296 - 0.5; };

function writeStore(file, runs) {
  const out = openSync(file, "w");
  let count = 0;
  writeSync(out, '{"stillpoint_store":1,"plans":[],"accepted":[],"runs":[\n');
  for (const run of runs) writeSync(out, (count++ ? ",\n" : "") + JSON.stringify(run));
  writeSync(out, "]}");
  closeSync(out);
}

// TILES copies of the rows of a table, each later than the one before.
function tiled(text, shift) {
  const lines = text.trimEnd().split("\n"), head = lines.filter((line) => /^[a-z#]/.test(line)), rows = lines.slice(head.length);
  return [...head, ...Array.from({ length: TILES }, (_, k) => rows.map((row) => shift(row, k))).flat()].join("\n") + "\n";
}

const laterPose = (row, k) => row.replace(/^\d+/, (seconds) => Number(seconds) + SECONDS * k);
function laterFrame(row, k, hasTime) {
  const cells = row.split(",");
  cells[0] = Number(cells[0]) + FRAMES * k;
  if (hasTime) cells[1] = BigInt(cells[1]) + BigInt(SECONDS * 1e9 * k);
  return cells.join(",");
}

function ofAMinute({ attachments, ...run }) {
  const long = { ...attachments, trajectory: tiled(attachments.trajectory, laterPose), timings: tiled(attachments.timings, (row, k) => laterFrame(row, k, false)) };
  for (const name of ["counters", "claims"]) long[name] = tiled(attachments[name], (row, k) => laterFrame(row, k, true));
  let last = 0; // poses of the ground truth overlap
  long.truth = tiled(attachments.truth, laterPose).split("\n").filter((row) => { const later = parseFloat(row) > last; if (later) last = parseFloat(row); return later; }).join("\n") + "\n";
  return { ...run, attachments: long };
}

const displaced = (row) => { const cells = row.split(" "); return row.startsWith("#") || cells.length < 8 ? row : [cells[0], ...cells.slice(1, 4).map((value) => (Number(value) + 0.004 * random()).toFixed(6)), ...cells.slice(4)].join(" "); };

function* runs(file, first, last) {
  const sources = JSON.parse(readFileSync(file)).runs.filter((run) => run.outcome === "ok" && !run.identity.axis && !run.identity.sequence.includes("+")).map(ofAMinute);
  const sequences = ["walking_xyz", "market", "corridor", "office", "cafe"];
  for (let i = first; i < last; ++i) {
    const { key, ...source } = sources[i % sources.length], variant = i % 10, place = Math.floor(i / 10) % sequences.length;
    yield { ...source, metrics: source.metrics.map((metric) => ({ ...metric, value: metric.value * (1 + 0.1 * random() + 0.02 * variant) })),
      attachments: { ...source.attachments, trajectory: source.attachments.trajectory.split("\n").map(displaced).join("\n") },
      identity: { ...source.identity, variant: "variant_" + variant, config_hash: "c" + variant, sequence: sequences[place], sequence_id: "s" + place, seed: 1 + Math.floor(i / 50) } };
  }
}

function* history() {
  const names = ["ate_rmse_m:m", "coverage:", "process_cpu_s:s", "resets:", "rpe_trans_rmse_m_per_s:m/s", "rpe_rot_rmse_deg_per_s:deg/s", "correct_rate:", "first_pose_s:s", "peak_memory_mb:MB", "wall_s:s"];
  const modules = ["state_optimization", "feature_tracking", "feature_detection", "dynamic_recognition", "marginalization"];
  for (let i = 0; i < 300; ++i) for (let subject = 0; subject < 34; ++subject) {
    const commit = ((i + 1) * 2654435761 % 4294967296).toString(16).padStart(8, "0").repeat(5), t = new Date(Date.UTC(2026, 0, 1) + 72e6 * i).toISOString().slice(0, 19) + "Z";
    const level = (subject === 3 && i > 200 ? 1.3 : 1) * (1 + 0.03 * random());
    yield { identity: { system: "stillpoint", variant: "variant_" + subject % 4, sequence: "sequence_" + Math.floor(subject / 4), sequence_id: "d" + Math.floor(subject / 4), config_hash: "c" + subject % 4, build: commit, mode: "sequential",
      kind: "accuracy", cores: "", seed: 1, repetition: 1, axis: "", axis_value: 0 }, outcome: "ok", detail: "", started: t, ended: t, attachments: {},
    metrics: names.map((name, k) => ({ name: name.split(":")[0], unit: name.split(":")[1], protocol: "r", value: /^(resets|coverage)/.test(name) ? 1 : (0.02 + k) * level * (1 + 0.02 * random()) })),
    costs: modules.map((module, k) => ({ module, per: "call", calls: 90, mean_ms: (1 + k) * level, median_ms: (1 + k) * level, p95_ms: 2 + k, max_ms: 3 + k })),
    manifest: JSON.stringify({ host: { cpu: "Desktop", logical_cpus: 2 }, build: { git_commit: commit, git_time: t, git_changes: "" } }) };
  }
}

async function visit(url) {
  const { browser } = await import("./browser.mjs"), times = [];
  for (let i = 0; i < 5; ++i) {
    const page = await browser.newPage({ viewport: { width: 1400, height: 900 } });
    await page.goto(url);
    await page.waitForFunction(() => document.documentElement.dataset.readyMs !== undefined && performance.getEntriesByType("paint").length > 0);
    times.push(await page.evaluate(() => [performance.getEntriesByType("paint")[0].startTime, Number(document.documentElement.dataset.readyMs)]));
    await page.close();
  }
  const shown = (k) => { const sorted = times.map((pair) => Math.round(pair[k])).toSorted((a, b) => a - b); return `${sorted[2]} ms (${sorted[0]} to ${sorted[4]})`; };
  console.log(`${url.replace(/.*\/(?=[^/]+\/[^/]*$)/, "")}: first paint ${shown(0)}, ready ${shown(1)}`);
}

if (mode === "runs") writeStore(rest[3], runs(rest[0], Number(rest[1]), Number(rest[2])));
else if (mode === "history") writeStore(rest[0], history());
else {
  for (const url of rest) await visit(url);
  await (await import("./browser.mjs")).browser.close();
}
