#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Generates one site of the documents and the reference of the public headers with Doxygen, in build/docs/html. Fails on any
# warning and on any dead link.
#   scripts/docs.sh [--diagrams]   --diagrams: makes the SVG of each diagram in core/diagrams with Graphviz, and nothing else
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# The SVG names the checksum of its source, by which scripts/documents.sh checks that it is up to date.
if [[ "${1:-}" == --diagrams ]]; then
  command -v dot >/dev/null || { echo "docs: error: Graphviz is missing; run scripts/setup.sh --docs" >&2; exit 2; }
  for source in core/diagrams/*.dot; do
    { dot -Tsvg "$source" | grep -vE '^(<!--| -->)'; echo "<!-- source: $(sha256sum "$source" | cut -c1-64) -->"; } >"${source%.dot}.svg"
  done
  exit 0
fi
if ! command -v doxygen >/dev/null; then
  echo "docs: error: doxygen is missing; run scripts/setup.sh --docs" >&2
  exit 2
fi

headers="$(cmake -P scripts/cmake/public_headers.cmake)"
version="$(sed -nE 's/^project\(stillpoint VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)"
documents="$(git ls-files -c -o --exclude-standard -- '*.md' 2>/dev/null ||
  find . -name '*.md' -not -path './build/*' | sed 's|^\./||')"
rm -rf build/docs
mkdir -p build/docs
pages=()
for document in $documents; do
  mkdir -p "build/docs/pages/$(dirname "$document")"
  scripts/docs/for_doxygen.pl "$document" $headers >"build/docs/pages/$document"
  pages+=("build/docs/pages/$document")
done
images="$(find reports/figures core/diagrams -name '*.svg' -o -name '*.png' -o -name '*.jpg')"
{
  cat scripts/docs/Doxyfile
  echo "PROJECT_NUMBER = $version"
  echo "INPUT = ${pages[*]} ${headers//$'\n'/ }"
  echo "HTML_EXTRA_FILES = ${images//$'\n'/ }"
} | doxygen -

dead="$(grep -ohE '(href|src)="[^"#:]+["#]' build/docs/html/*.html | tr -d "#" | cut -d'"' -f2 | sort -u |
  while read -r target; do [[ -e "build/docs/html/$target" ]] || echo "$target"; done)"
[[ -z "$dead" ]] || { printf 'docs: dead link: %s\n' $dead; exit 1; }
echo "docs: $(wc -l <<<"$documents") documents, $(wc -l <<<"$headers") headers; open build/docs/html/index.html"
