#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the scripts of scripts/ci_example in a small repository with fakes of cmake and stillpoint that log their calls.
# Checks the order of the steps and the exit codes.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"
export STAGE="$scratch"
rm -rf "$scratch"
mkdir -p "$scratch/bin" "$scratch/repository/build/release"
cat >"$scratch/bin/cmake" <<'FAKE'
#!/usr/bin/env bash
echo "cmake $*" >>"$STAGE/calls"
mkdir -p build/release
cp "$STAGE/stillpoint" build/release/stillpoint
FAKE
cat >"$scratch/stillpoint" <<'FAKE'
#!/usr/bin/env bash
echo "stillpoint $1" >>"$STAGE/calls"
exit_code="$STAGE/exit_code_$1"
[[ ! -e "$exit_code" ]] || exit "$(cat "$exit_code")"
FAKE
chmod +x "$scratch"/bin/* "$scratch/stillpoint"
cd "$scratch/repository"
export GIT_CONFIG_GLOBAL=/dev/null
git init -q
git -c user.name=t -c user.email=t@example.org commit -q --allow-empty -m base

# run_script SCRIPT ARGUMENTS...: prints the exit code; the calls are logged in $STAGE/calls
run_script() {
  local script="$1" code=0
  shift
  rm -f "$STAGE/calls"
  PATH="$STAGE/bin:$PATH" "$root/scripts/ci_example/$script" "$@" >"$STAGE/output" 2>&1 || code=$?
  echo "$code"
}
steps() { grep '^stillpoint' "$STAGE/calls" | tr '\n' ';'; }
# set_exit_code COMMAND CODE: exit code of a subcommand of the fake stillpoint
set_exit_code() { echo "$2" >"$STAGE/exit_code_$1"; }

[[ "$(run_script history.sh history out)" == 0 ]] || fail "history.sh fails without regressions: $(cat "$STAGE/output")"
[[ "$(steps)" == "stillpoint bench;stillpoint dashboard;stillpoint regressions;" ]] || fail "history.sh calls $(steps)"
[[ -d history && -e out/regressions.md ]] || fail "the history folder or regressions.md is missing"
[[ "$(run_script history.sh history out accepted.json)" == 0 ]] || fail "history.sh fails with accepted changes"
[[ "$(steps)" == "stillpoint bench;stillpoint store;stillpoint dashboard;stillpoint regressions;" ]] || fail "with accepted changes, history.sh calls $(steps)"
set_exit_code regressions 1
[[ "$(run_script history.sh history out)" == 1 ]] || fail "an open regression does not fail history.sh"
[[ "$(steps)" == *dashboard* ]] || fail "the dashboard is not written if a regression is open"
set_exit_code bench 2
[[ "$(run_script history.sh history out)" == 2 ]] || fail "an error of bench does not fail history.sh"

[[ "$(run_script gate.sh HEAD gate)" == 0 ]] || fail "gate.sh fails without regressions: $(cat "$STAGE/output")"
[[ "$(steps)" == "stillpoint compare;stillpoint report;" ]] || fail "gate.sh calls $(steps)"
for code in 1 2; do
  set_exit_code compare $code
  [[ "$(run_script gate.sh HEAD gate)" == $code ]] || fail "gate.sh does not return exit code $code of compare"
done
set_exit_code compare 3
[[ "$(run_script gate.sh HEAD gate)" == 3 ]] || fail "an inconclusive comparison does not fail gate.sh"
[[ "$(run_script gate.sh HEAD gate --allow-inconclusive)" == 0 ]] || fail "gate.sh ignores --allow-inconclusive"
echo '<testcase><error message="0 pairs of runs"/></testcase>' >gate/compare.xml
[[ "$(run_script gate.sh HEAD gate)" == 2 ]] || fail "a comparison of nothing does not fail gate.sh"
[[ "$(git worktree list | wc -l)" == 1 ]] || fail "gate.sh does not remove its work tree"
finish
