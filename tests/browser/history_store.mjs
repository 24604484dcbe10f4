// SPDX-License-Identifier: BSD-3-Clause
// Prints a store with a synthetic history, for `stillpoint store import`: 60 commits, two machines, a step in cost, a
// step of the error in the last two, a drift of the error, and hostile names. Usage: node history_store.mjs [KEY...] > FILE
const COMMITS = 60, STEP = 40;
const HOSTILE = `"><img src=x onerror=alert(1)>'\\$&%_#{}~^</script>\u202e\u{1F600}` + "long".repeat(60);

// Pseudo-random generator with a fixed seed, for reproducible output.
let random = 7;
const noise = () => {
  let sum = 0;
  for (let i = 0; i < 12; ++i) {
    random = (Math.imul(random, 1664525) + 1013904223) >>> 0;
    sum += random / 4294967296;
  }
  return sum - 6;
};

const hex = (i) => (i * 2654435761 % 4294967296).toString(16).padStart(8, "0").repeat(5);
const time = (i) => new Date(Date.UTC(2026, 0, 1 + i)).toISOString().slice(0, 19) + "Z";

function run(i, variant, sequence, cpu, numbers) {
  const commit = i === 5 ? HOSTILE : hex(i);
  return {
    identity: { system: "stillpoint", variant, sequence, sequence_id: "data", config_hash: "c", build: commit, mode: "sequential", kind: "accuracy",
      cores: "", seed: 1, repetition: 1, axis: "", axis_value: 0, },
    outcome: "ok", detail: "", started: time(i), ended: time(i), attachments: {},
    metrics: [["ate_rmse_m", "m", numbers.ate], ["coverage", "", 0.96], ["process_cpu_s", "s", numbers.cpu], ["resets", "", 0]]
      .map(([name, unit, value]) => ({ name, protocol: "r", unit, value })),
    costs: [["state_optimization", numbers.solve], ["feature_tracking", numbers.track]]
      .map(([module, mean]) => ({ module, per: "call", calls: 90, mean_ms: mean, median_ms: mean, p95_ms: 1.5 * mean, max_ms: 2 * mean })),
    manifest: JSON.stringify({ host: { cpu, logical_cpus: 2 }, build: { git_commit: commit, git_time: time(i), git_changes: "" } }),
  };
}

const runs = [];
const near = (value, relativeSigma) => value * (1 + relativeSigma * noise());
for (let i = 0; i < COMMITS; ++i) {
  const solve = near(i < STEP ? 4.0 : 4.6, 0.01), track = near(i < 20 ? 2.0 : 1.7, 0.01);
  runs.push(run(i, "stillpoint", "walking_xyz", "Desktop", { ate: near(0.02 * (1 + 0.003 * i), 0.01), cpu: near(10 + solve + track, 0.01), solve, track }));
  runs.push(run(i, "vo", "walking_xyz", "Desktop", { ate: near(i < 30 ? 0.03 : 0.036, 0.01), cpu: near(12, 0.01), solve: near(5, 0.01), track: near(2, 0.01) }));
  if (i % 2 === 0) runs.push(run(i, "vo", "walking_xyz", "Small device", { ate: near(0.03, 0.01), cpu: near(30, 0.01), solve: near(15, 0.01), track: near(6, 0.01) }));
  if (i >= 20) runs.push(run(i, "stillpoint", "market", "Desktop", { ate: near(i < COMMITS - 2 ? 0.05 : 0.07, 0.01), cpu: 12, solve: 5, track: 2 }));
  if (i > 50) runs.push(run(i, HOSTILE, HOSTILE, HOSTILE, { ate: 0.01, cpu: 10, solve: 3, track: 2 }));
}
const accepted = [{ commit: hex(30), metric: "ate_rmse_m", variant: "vo", sequence: "", reason: `a faster solver <b>"worth" it</b>`, accepted: time(61) }];
// Run keys do not include the machine; runs of the second machine get another repetition to differ.
for (const one of runs) if (one.manifest.includes("Small device")) one.identity.repetition = 2;
// With run keys as arguments: only a plan that contains these runs.
const keys = process.argv.slice(2);
const plans = keys.length ? [{ name: HOSTILE, title: HOSTILE, text: "", run_keys: keys }] : [];
console.log(JSON.stringify({ stillpoint_store: 1, plans, runs: keys.length ? [] : runs, accepted: keys.length ? [] : accepted }));
