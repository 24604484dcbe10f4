#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A plan executed by a Slurm of one node gives the same store as on this machine, also if a worker and the calling program
# are killed.   slurm_test.sh PROGRAM
source "$(dirname "${BASH_SOURCE[0]}")/cluster.sh" "$1" munged mungekey slurmctld slurmd sbatch squeue scancel sinfo

node="$(hostname -s)"
user="$(id -un)"
mkdir -p "$work/state" "$work/spool" "$work/munge"
chmod 700 "$work/munge"
chmod 755 "$work"
mungekey --create --keyfile="$work/munge/key"
cat >"$work/slurm.conf" <<CONF
ClusterName=stillpoint
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval=1
ReturnToService=2
JobRequeue=1
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN Features=test_class
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$work/slurm.conf"
before_stop() { scancel --user="$user" --signal=KILL --full 2>/dev/null; scancel --user="$user" 2>/dev/null; }

start munged munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
  --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" --num-threads=2
wait_until 20 test -S "$work/munge/socket"
start slurmctld slurmctld -D
start slurmd slurmd -D
is_idle() { [[ "$(sinfo --noheader --format=%t)" == idle ]]; }
wait_until 60 is_idle

write_plan plan 2
bench plan local --jobs 2 || fail "local execution: $(tail -n 3 "$work/bench-local.log")"
[[ "$(runs_in local)" == 8 ]] || fail "8 runs expected, $(runs_in local) found"

bench plan slurm --executor slurm --tasks 4 || fail "execution by Slurm: $(tail -n 3 "$work/bench-slurm.log")"
grep -q '4 tasks' "$work/bench-slurm.log" || fail "not 4 tasks"
expect_equal local slurm
bench plan slurm --executor slurm --tasks 4 || fail "second execution"
grep -q '0 of 8 runs executed, 8 cached' "$work/bench-slurm.log" || fail "completed runs were executed again"
echo "equal stores: local and Slurm with 4 tasks"
check_systems --executor slurm --tasks 4

# The calling program is killed as soon as the first task has a store, then a worker is killed: the second call waits for
# the other tasks, and executes what is missing.
write_plan many 5
bench many many_local --jobs 2 || fail "local execution of 20 runs"
bench many killed --executor slurm --tasks 4 &
caller=$!
has_store() { compgen -G "$work/killed.sqlite.jobs/*/job/store-*.sqlite" >/dev/null; }
wait_until 60 has_store
kill -KILL "$(pgrep -P "$caller" -f "$program bench" | head -n 1 || echo "$caller")" "$caller" 2>/dev/null || true
wait "$caller" 2>/dev/null || true
is_running() { [[ -n "$(worker_pids)" ]]; }
worker_pids() { pgrep -f "$program worker run $work/killed.sqlite.jobs" || true; }
wait_until 60 is_running
kill -KILL "$(worker_pids | head -n 1)"
bench many killed --executor slurm --tasks 4 || fail "continued execution: $(tail -n 3 "$work/bench-killed.log")"
grep -q 'of an earlier call' "$work/bench-killed.log" || fail "the second call did not wait for the first jobs"
expect_equal many_local killed
echo "equal stores after a worker and the calling program were killed"

sed 's/^title/kind = "timing"\ntitle/' "$work/plan.toml" >"$work/timing.toml"
! bench timing timing --executor slurm || fail "timing runs without a machine class were accepted"
bench timing timing --executor slurm --machine-class test_class --tasks 1 || fail "timing runs of a machine class"
echo "timing runs on nodes of one class"
