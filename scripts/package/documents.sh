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

"$root/scripts/package/man_page.sh" "$program" "$folder/stillpoint.1.gz"

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
