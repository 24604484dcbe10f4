#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs scripts/setup.sh against a stage machine: dpkg-query, apt-get and sudo that only write down what is asked.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"
export STAGE="$scratch"

# stage MISSING...: packages that the stage machine lacks
stage() {
  rm -rf "$scratch"
  mkdir -p "$scratch/bin"
  printf '%s\n' "$@" >"$scratch/missing"
  cat >"$scratch/bin/dpkg-query" <<'FAKE'
#!/usr/bin/env bash
if grep -qxF -- "${!#}" "$STAGE/missing"; then exit 1; fi
printf installed
FAKE
  cat >"$scratch/bin/apt-get" <<'FAKE'
#!/usr/bin/env bash
echo "$*" >>"$STAGE/asked"
if [[ "$*" == *update && -e "$STAGE/first_update_fails" ]]; then rm "$STAGE/first_update_fails"; exit 100; fi
FAKE
  printf '#!/usr/bin/env bash\nexec "$@"\n' >"$scratch/bin/sudo"
  printf '#!/usr/bin/env bash\n' >"$scratch/bin/sleep"
  chmod +x "$scratch"/bin/*
}
run_setup() { PATH="$scratch/bin:$PATH" "$root/scripts/setup.sh" "$@" >"$scratch/output" 2>&1; }
asked() { cat "$scratch/asked" 2>/dev/null || true; }

stage nothing
run_setup || fail "a full machine is refused"
[[ -z "$(asked)" ]] || fail "apt is called although nothing is missing: $(asked)"

stage libceres-dev libfmt-dev
run_setup || fail "installing fails"
[[ "$(asked)" == "-q -y update
-q -y install --no-install-recommends libceres-dev libfmt-dev" ]] || fail "not what was missing: $(asked)"

stage libceres-dev
touch "$scratch/first_update_fails"
run_setup || fail "one failed update ends the set-up"
[[ "$(asked | grep -c update)" == 2 ]] || fail "the update is not tried again: $(asked)"

stage clang-tidy
run_setup || fail "a full machine is refused"
[[ -z "$(asked)" ]] || fail "clang-tidy is installed without --dev"
run_setup --dev || fail "--dev is refused"
[[ "$(asked)" == *"clang-tidy" ]] || fail "--dev does not install clang-tidy"

stage libembree-dev libceres-dev
run_setup --minimal || fail "--minimal is refused"
[[ "$(asked)" == *"install --no-install-recommends libceres-dev" ]] || fail "--minimal installs more: $(asked)"
run_setup --minimal --list || fail "--minimal --list is refused"
if grep -qE 'assimp|embree|tbb|sqlite|curl|archive|cairo|microhttpd|proj|gtest' "$scratch/output"; then
  fail "--minimal lists what it does not need"
fi

stage nothing
if run_setup --devel; then fail "an unknown option is taken"; fi
finish
