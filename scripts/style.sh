#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks what of CONTRIBUTING.md a few patterns can check: licence lines, lengths of files, include guards, and words
# that are not to be in sources. Prints each fault as a file; exit 1 if there is one.
#   scripts/style.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

faults=0
complain() { # TEXT, files on the standard input
  while read -r file; do
    echo "$file: $1"
    faults=$((faults + 1))
  done
}
sources() { find core datasets eval bench reports tests -name '*.h' -o -name '*.cpp' | sort; }

while read -r file; do
  head -n 1 "$file" | grep -q 'SPDX-License-Identifier: BSD-3-Clause' || complain "no SPDX line at the top" <<<"$file"
  (($(wc -l <"$file") <= 300)) || complain "more than 300 lines" <<<"$file"
done < <(sources)
complain "no #pragma once" < <(sources | grep '\.h$' | xargs grep -L '^#pragma once$' || true)
complain "using namespace at file scope" < <(sources | xargs grep -l '^using namespace ' || true)
complain "TODO without an issue" < <(sources | xargs grep -lE 'TODO($|[^(]|\([^#])|FIXME' || true)

((faults == 0)) || { echo "style: $faults fault(s)"; exit 1; }
echo "style: clean"
