#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the scripts of scripts/ci_example in a small repository, with a compiler and a program that only write down what
# is asked: the order of their steps, and the exit codes that CI sees.
source "$(dirname "${BASH_SOURCE[0]}")/ground.sh"
export STAGE="$scratch"
rm -rf "$scratch"
mkdir -p "$scratch/bin" "$scratch/repository/build/release"
cat >"$scratch/bin/cmake" <<'FAKE'
#!/usr/bin/env bash
echo "cmake $*" >>"$STAGE/asked"
mkdir -p build/release
cp "$STAGE/stillpoint" build/release/stillpoint
FAKE
cat >"$scratch/stillpoint" <<'FAKE'
#!/usr/bin/env bash
echo "stillpoint $1" >>"$STAGE/asked"
verdict="$STAGE/verdict_$1"
[[ ! -e "$verdict" ]] || exit "$(cat "$verdict")"
FAKE
chmod +x "$scratch"/bin/* "$scratch/stillpoint"
cd "$scratch/repository"
export GIT_CONFIG_GLOBAL=/dev/null
git init -q
git -c user.name=t -c user.email=t@example.org commit -q --allow-empty -m base

# exit_code SCRIPT ARGUMENTS...: what CI sees; what was asked is in $STAGE/asked
exit_code() {
  local script="$1" code=0
  shift
  rm -f "$STAGE/asked"
  PATH="$STAGE/bin:$PATH" "$root/scripts/ci_example/$script" "$@" >"$STAGE/output" 2>&1 || code=$?
  echo "$code"
}
steps() { grep '^stillpoint' "$STAGE/asked" | tr '\n' ';'; }
# verdict COMMAND CODE: how a command of the program ends
verdict() { echo "$2" >"$STAGE/verdict_$1"; }

[[ "$(exit_code history.sh kept out)" == 0 ]] || fail "a quiet history fails: $(cat "$STAGE/output")"
[[ "$(steps)" == "stillpoint bench;stillpoint dashboard;stillpoint regressions;" ]] || fail "history runs $(steps)"
[[ -d kept && -e out/regressions.md ]] || fail "the history is not kept, or its regressions are not written"
[[ "$(exit_code history.sh kept out accepted.json)" == 0 ]] || fail "accepted changes are refused"
[[ "$(steps)" == "stillpoint bench;stillpoint store;stillpoint dashboard;stillpoint regressions;" ]] || fail "with accepted changes it runs $(steps)"
verdict regressions 1
[[ "$(exit_code history.sh kept out)" == 1 ]] || fail "an open regression does not fail the job"
[[ "$(steps)" == *dashboard* ]] || fail "an open regression keeps the dashboard from being made"
verdict bench 2
[[ "$(exit_code history.sh kept out)" == 2 ]] || fail "a broken benchmark goes unnoticed"

[[ "$(exit_code gate.sh HEAD gate)" == 0 ]] || fail "a good change fails: $(cat "$STAGE/output")"
[[ "$(steps)" == "stillpoint compare;stillpoint report;" ]] || fail "the gate runs $(steps)"
for code in 1 2; do
  verdict compare $code
  [[ "$(exit_code gate.sh HEAD gate)" == $code ]] || fail "the gate lets a change pass that ends with $code"
done
verdict compare 3
[[ "$(exit_code gate.sh HEAD gate)" == 0 ]] || fail "a change that could not be judged fails"
[[ "$(git worktree list | wc -l)" == 1 ]] || fail "the gate leaves a work tree behind"
finish
