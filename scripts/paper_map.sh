#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that README leads nowhere wrong: every path of the paper map exists, and so does every linked file.
#   scripts/paper_map.sh [ROOT]
# A path of the map is a folder, a file, or a pair of files named without their endings.
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

missing=0
complain() {
  echo "README.md: $1"
  missing=$((missing + 1))
}

rows="$(sed -n '/<!-- paper map -->/,/<!-- end of paper map -->/p' README.md | grep '^|' | tail -n +3 || true)"
paths="$(cut -d'|' -f3 <<<"$rows" | grep -o '`[^`]*`' | tr -d '`' || true)"
[[ -n "$paths" ]] || complain "the paper map is empty"
while read -r path; do
  [[ -e "$path" || -e "$path.h" ]] || complain "the paper map names $path, which does not exist"
done <<<"$paths"
rows_without_path="$(cut -d'|' -f3 <<<"$rows" | grep -vc '`' || true)"
((rows_without_path == 0)) || complain "$rows_without_path row(s) of the paper map name no path"

while read -r target; do
  [[ -e "$target" ]] || complain "links to $target, which does not exist"
done < <(grep -oE '\]\([^)#]+' README.md | cut -c3- | grep -vE '^https?:' || true)

((missing == 0)) || { echo "paper map: $missing fault(s)"; exit 1; }
echo "paper map: $(wc -l <<<"$paths") paths exist"
