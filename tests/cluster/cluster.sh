# SPDX-License-Identifier: BSD-3-Clause
# Common parts of the tests with Slurm and sshd: sourced as `source cluster.sh PROGRAM REQUIRED_COMMAND...`. All services
# are started by the test with configurations in a temporary folder, and stopped by their process ids at its end.
# Exits with 77 and a reason if a command is not installed.
set -euo pipefail

program="$1"
shift
PATH="$PATH:/usr/sbin"
for command in "$@"; do
  command -v "$command" >/dev/null || { echo "skipped: $command is not installed; run scripts/setup.sh --all"; exit 77; }
done

work="$(mktemp -d /tmp/stillpoint-cluster-XXXXXX)"
pids=()
stop_services() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
}
finish() {
  local status=$?
  before_stop || true
  stop_services
  ((status == 0)) || for log in "$work"/*.log "$work"/*.jobs/*/*.log; do
    [[ -e "$log" ]] && { echo "--- $log"; tail -n 30 "$log"; }
  done
  rm -rf "$work"
}
before_stop() { :; }
trap finish EXIT

# start LOG COMMAND...: a service in the foreground of a background process
start() {
  "${@:2}" </dev/null >"$work/$1.log" 2>&1 &
  pids+=($!)
}

# wait_until SECONDS COMMAND...
wait_until() {
  local end=$((SECONDS + $1))
  until "${@:2}" >/dev/null 2>&1; do
    ((SECONDS < end)) || { echo "error: not within $1 s: ${*:2}"; return 1; }
    sleep 0.1
  done
}

# A port that is free now; the ports below 32768 are not given to outgoing connections
free_port() {
  local port
  while port=$((20000 + RANDOM % 12000)); do
    (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || { echo "$port"; return; }
  done
}

fail() { echo "error: $*"; exit 1; }

export STILLPOINT_REGISTRY="$work/registry.json" STILLPOINT_CACHE="$work/cache" STILLPOINT_DATA="$work/data"
mkdir -p "$work/data"

# The description of another system, which the workers of ssh get with the job.
mkdir -p "$work/systems"
printf '!/^#/ { print $1, 0, 0, 0, 0, 0, 0, 1 > "toy.tum" }\n' >"$work/systems/toy.awk"
printf 'name = "toy"\ncommand = ["awk", "-f", "{here}/toy.awk", "{sequence}/rgb.txt"]\ntrajectory = "toy.tum"\n' \
  >"$work/systems/toy.toml"

# write_plan NAME REPETITIONS: 2 variants x 2 sequences x repetitions
write_plan() {
  cat >"$work/$1.toml" <<PLAN
title = "Short runs"
variants = ["stillpoint", "vo"]
repetitions = $2
max_frames = 15
images = 2
[rendered]
sequences = ["walking_static", "walking_xyz"]
seconds = 0.5
PLAN
}

# bench NAME STORE OPTIONS...: executes the plan; the output is in $work/bench.log
bench() {
  "$program" bench "$work/$1.toml" --store "$work/$2.sqlite" --out "$work/out-$2" "${@:3}" >"$work/bench-$2.log" 2>&1
}

expect_equal() {
  "$program" store verify --equal "$work/$1.sqlite" "$work/$2.sqlite" || fail "the stores $1 and $2 differ"
  "$program" store verify --store "$work/$2.sqlite" >/dev/null || fail "the store $2 is damaged"
}

# check_systems OPTIONS...: runs of another system, whose description and script the workers of ssh get with the job
check_systems() {
  write_plan systems 2
  sed -i "s|^variants.*|systems = [\"$work/systems/toy.toml\"]|" "$work/systems.toml"
  bench systems systems_local || fail "local execution of another system: $(tail -n 3 "$work/bench-systems_local.log")"
  bench systems systems_sent "$@" || fail "execution of another system: $(tail -n 3 "$work/bench-systems_sent.log")"
  grep -q '4 of 4 runs executed' "$work/bench-systems_sent.log" || fail "not 4 runs of another system"
  expect_equal systems_local systems_sent
  echo "equal stores of another system"
}

runs_in() { "$program" store list --store "$work/$1.sqlite" 2>/dev/null | grep -cE '^[0-9a-f]{16} ' || true; }
