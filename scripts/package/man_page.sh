#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes the man page, compressed: the help of all commands of the program.
#   scripts/package/man_page.sh PROGRAM PAGE
set -euo pipefail
program="$1" page="$2"
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
version="$("$program" --version | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -n 1)"
seconds="$(git -C "$root" log -1 --format=%ct 2>/dev/null || date +%s)"
mkdir -p "$(dirname "$page")"

# Dashes of options are minus signs, and leading dots and quotes are no requests of roff.
roff() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }
subcommands() { awk '/^[A-Z]/ { on = $1 == "Subcommands:"; next } on && /^  [a-z]/ { print $1 }' <<<"$help"; }
section() { # SUBCOMMAND...; leaves its help in `help`
  help="$("$program" "$@" --help)"
  printf '.SS "%s"\n.nf\n' "stillpoint${*:+ $*}"
  fold -s -w 76 <<<"$help" | roff
  printf '.fi\n'
}
{
  printf '.TH STILLPOINT 1 "%s" "stillpoint %s"\n' "$(date -u -d "@$seconds" +%Y-%m-%d)" "$version"
  printf '.SH NAME\nstillpoint \\- RGB\\-D inertial odometry for dynamic scenes\n'
  printf '.SH SYNOPSIS\n.B stillpoint\nSUBCOMMAND [OPTIONS]\n.SH COMMANDS\n'
  section
  for command in $(subcommands); do
    section "$command"
    for inner in $(subcommands); do section "$command" "$inner"; done
  done
  printf '.SH EXIT STATUS\n0: completed. 1: completed with a negative result. 2: invalid usage or input.\n'
  printf '3: inconclusive. 70: internal error. 130: interrupted.\n'
} | gzip -9n >"$page"
