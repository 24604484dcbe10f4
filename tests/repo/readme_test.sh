#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Executes the commands of README.md, in their order, in an empty folder, and expects each to succeed and to print what the
# README shows, up to numbers and widths of columns. Downloads come from a server on this machine.
#   tests/repo/readme_test.sh README PROGRAM MIRROR_SERVER SCRATCH
# Commands are the lines "$ COMMAND" of the blocks marked ```console; the lines below are the output. "..." stands for any
# lines, or for the rest of a line.
set -euo pipefail
readme="$(realpath "$1")" program="$(realpath "$2")" server="$(realpath "$3")" scratch="$4"
rm -rf "$scratch"
mkdir -p "$scratch/work" "$scratch/home" "$scratch/host/tum/freiburg3" "$scratch/catalogue"
scratch="$(realpath "$scratch")"
cd "$scratch/work"

failures=0
fail() {
  echo "FAILED: $1"
  failures=$((failures + 1))
}

coproc host { exec "$server" "$scratch/host" 0; }
trap 'kill "$host_PID"' EXIT
read -r STILLPOINT_MIRROR <&"${host[0]}"
export STILLPOINT_MIRROR PATH="$(dirname "$program"):$PATH" HOME="$scratch/home"
export STILLPOINT_CATALOGUE="$scratch/catalogue" STILLPOINT_DATA="$scratch/data"
export STILLPOINT_REGISTRY="$scratch/registry.json" STILLPOINT_CACHE="$scratch/cache"

# The public sequence that the README downloads: the rendered one in its place.
offer_sequence() {
  local name=rgbd_dataset_freiburg3_walking_xyz
  stillpoint data export seq --layout tum --out "$scratch/$name" >/dev/null
  tar -C "$scratch" -czf "$scratch/host/tum/freiburg3/$name.tgz" "$name"
  cat >"$scratch/catalogue/tum.toml" <<TOML
name = "tum"
title = "Test"
licence = "free"
layout = "tum"
urls = ["$STILLPOINT_MIRROR/tum/{}"]
[[sequences]]
files = ["freiburg3/$name.tgz"]
folder = "$name"
members = ["fr3_walking_xyz"]
TOML
}

# Numbers as N, runs of blanks and dashes as one.
shape() { sed -E 's/[0-9]+(\.[0-9]+)?/N/g; s/-+/-/g; s/ +/ /g; s/ $//'; }

# expect COMMAND EXPECTED: runs the command, and compares the shape of what it prints
expect() {
  local expected_line shown output="$scratch/output" any=true
  [[ "$1" != *"data get"* ]] || offer_sequence
  if ! bash -o pipefail -c "$1" >"$output" 2>"$scratch/errors"; then
    fail "$1: $(tail -n 3 "$scratch/errors")"
    return
  fi
  echo "ok: $1"
  [[ -n "$2" ]] || return 0
  exec 3< <(shape <"$output")
  while read -r expected_line; do
    if [[ "$expected_line" == ... ]]; then
      any=true
      continue
    fi
    local pattern="$expected_line"
    pattern="$(shape <<<"${pattern% ...}")"
    local found=false
    while read -r -u 3 shown; do
      if [[ "$shown" == "$pattern" || ("$expected_line" == *" ..." && "$shown" == "$pattern"*) ]]; then
        found=true
        break
      fi
      $any || break
    done
    $found || { fail "$1 does not print \"$expected_line\" but: $(head -n 20 "$output")"; break; }
    any=false
  done <<<"$2"
  exec 3<&-
}

command="" expected="" commands=0 is_console=false
finish_command() {
  [[ -z "$command" ]] || { expect "$command" "$expected"; commands=$((commands + 1)); }
  command="" expected=""
}
while IFS= read -r line; do
  case "$line" in
    '```console') is_console=true ;;
    '```') $is_console && finish_command; is_console=false ;;
    '$ '*) $is_console || continue; finish_command; command="${line#'$ '}" ;;
    *) $is_console && expected+="${expected:+$'\n'}$line" ;;
  esac
done <"$readme"
((commands > 0)) || fail "the README has no commands"
((failures == 0)) || exit 1
echo "$commands commands of the README, as shown"
