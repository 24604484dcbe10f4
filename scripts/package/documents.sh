#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes the documents of the Debian packages: man page (from the help of the program), copyright, changelog.
#   scripts/package/documents.sh PROGRAM FOLDER CONTACT
set -euo pipefail
program="$1" folder="$2" contact="$3"
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
version="$("$program" --version | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -n 1)"
seconds="$(git -C "$root" log -1 --format=%ct 2>/dev/null || date +%s)"
mkdir -p "$folder"

# Dashes of options are minus signs, and leading dots and quotes are no requests of roff.
roff() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }
subcommands() { "$program" "$@" --help | awk '/^[A-Z]/ { on = $1 == "Subcommands:"; next } on && /^  [a-z]/ { print $1 }'; }
section() { # TITLE SUBCOMMAND...
  printf '.SS "%s"\n.nf\n' "$1"
  "$program" "${@:2}" --help | fold -s -w 76 | roff
  printf '.fi\n'
}
{
  printf '.TH STILLPOINT 1 "%s" "stillpoint %s"\n' "$(date -u -d "@$seconds" +%Y-%m-%d)" "$version"
  printf '.SH NAME\nstillpoint \\- RGB\\-D inertial odometry for dynamic scenes\n'
  printf '.SH SYNOPSIS\n.B stillpoint\nSUBCOMMAND [OPTIONS]\n.SH COMMANDS\n'
  section stillpoint
  while read -r command; do
    section "stillpoint $command" "$command"
    while read -r inner; do section "stillpoint $command $inner" "$command" "$inner"; done < <(subcommands "$command")
  done < <(subcommands)
  printf '.SH EXIT STATUS\n0: completed. 1: completed with a negative result. 2: invalid usage or input.\n'
  printf '3: inconclusive. 70: internal error. 130: interrupted.\n'
} | gzip -9n >"$folder/stillpoint.1.gz"

{
  cat "$root/LICENSE"
  printf '\nThe program links SuiteSparse, which contains parts under the GNU General Public\n'
  printf 'License: redistribution of the binary is subject to it. On Debian systems its text\n'
  printf 'is in /usr/share/common-licenses/GPL-2.\n'
} >"$folder/copyright"
{
  printf 'stillpoint (%s) unstable; urgency=medium\n\n  * Build of the development version.\n\n' "$version"
  printf ' -- %s  %s\n' "$contact" "$(date -R -u -d "@$seconds")"
} | gzip -9n >"$folder/changelog.gz"
