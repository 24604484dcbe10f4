#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that the documents lead nowhere wrong: every path of the paper map (core/README.md), every link and every path in code
# marks exists, no document is longer than its limit, each diagram was made from its present source, and comments name headers
# that exist. With PROGRAM also: every configuration key exists (but in the changelog and in measurements, which are those of their builds).
#   scripts/documents.sh [ROOT [PROGRAM]]
# A path is a folder, a file, or a pair of files named without their endings; in code marks it begins with a folder of the root.
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"
program="${2:-}"

faults=0
complain() {
  echo "$1"
  faults=$((faults + 1))
}
exists() { [[ -e "$1" || -e "$1.h" || -e "$1.cpp" ]]; }
# All that git does not ignore; outside of a checkout, or in an ignored folder, all.
documents() { git ls-files -c -o --exclude-standard -- '*.md' 2>/dev/null | grep . || find . -name '*.md' | sed 's|^\./||'; }

map=core/README.md
rows="$(sed -n '/<!-- paper map -->/,/<!-- end of paper map -->/p' "$map" 2>/dev/null | grep '^|' | tail -n +3 || true)"
paths="$(cut -d'|' -f3 <<<"$rows" | grep -o '`[^`]*`' | tr -d '`' || true)"
[[ -n "$paths" ]] || complain "$map: the paper map is empty"
while read -r path; do
  exists "$path" || complain "$map: the paper map names $path, which does not exist"
done <<<"$paths"
rows_without_path="$(cut -d'|' -f3 <<<"$rows" | grep -vc '`' || true)"
((rows_without_path == 0)) || complain "$map: $rows_without_path row(s) of the paper map name no path"

# Links (outside of code blocks) are relative to the document, paths in code marks to the root. Words with wildcards or in capitals are no paths.
count=0
while read -r document; do
  [[ -f "$document" ]] || continue
  count=$((count + 1))
  while read -r target; do
    [[ -e "$(dirname "$document")/$target" ]] || complain "$document: links to $target, which does not exist"
  done < <(sed '/^ *```/,/^ *```/d' "$document" | grep -oE '(\]\(|src=")[^)#"]+' | sed -E 's/^(\]\(|src=")//' | grep -vE '^https?:' || true)
  [[ "$document" != CHANGELOG.md ]] || continue
  while read -r path; do
    exists "$path" || complain "$document: names $path, which does not exist"
  done < <(grep -oE '`(core|datasets|eval|bench|reports|scripts|tests)/[A-Za-z0-9_./-]+`' "$document" | tr -d '`' | grep -v '[A-Z]\{2\}' || true)
done < <(documents)

if [[ -n "$program" ]]; then
  keys="$("$program" config reference)"
  while IFS=: read -r document key; do
    grep -qF -e "\`$key\`" -e "\`$key." <<<"$keys" || complain "$document: names the key $key, which does not exist"
  done < <(documents | grep -vE '^(CHANGELOG|reports/measured/)' | xargs -d '\n' grep -oHE \
    '\b(backend|frontend|imu|dynamic|detector|loop|pipeline)\.[a-z_]+(\.[a-z_]+)*' | grep -vE '\.(txt|csv|h|cpp)$' | sort -u)
fi

# limit DOCUMENT... LINES
limit() {
  local document
  for document in "${@:1:$#-1}"; do
    [[ ! -f "$document" ]] || (($(wc -l <"$document") <= ${!#})) || complain "$document: more than ${!#} lines"
  done
}
limit README.md reports/measured/*.md 120
limit ARCHITECTURE.md 250

# A header that a comment names is a source, or, of a library, included there.
sources() { git ls-files -c -o --exclude-standard -- '*.h' '*.cpp' 2>/dev/null | grep . || find . -name '*.h' -o -name '*.cpp'; }
while read -r source header; do
  grep -q "^#include.*$header" "$source" || complain "$source: a comment names $header, which does not exist"
done < <(sources | xargs -d '\n' grep -sHE '//.*[a-z]\.h\b' |
  awk -v names="$(sources | sed 's|.*/||')" 'BEGIN {split(names, list); for (i in list) exists[list[i]]}
    {source = $0; sub(/:.*/, "", source); sub(/.*\/\//, "")
     while (match($0, /[a-z0-9_]+\.h/)) {
       name = substr($0, RSTART, RLENGTH); $0 = substr($0, RSTART + RLENGTH)
       if ($0 !~ /^[a-z]/ && !(name in exists)) print source, name}}' | sort -u)

for source in core/diagrams/*.dot; do
  [[ -f "$source" ]] || continue
  grep -qs "source: $(sha256sum "$source" | cut -c1-64)" "${source%.dot}.svg" ||
    complain "$source: its SVG is missing or made from another source; run scripts/docs.sh --diagrams"
done

((faults == 0)) || { echo "documents: $faults fault(s)"; exit 1; }
echo "documents: $count documents, $(wc -l <<<"$paths") paths of the paper map"
