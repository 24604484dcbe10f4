#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Finds types that are defined twice under one qualified name, which violates the one-definition rule (ODR) without a
# message from compiler or linker. Types in unnamed namespaces do not count. Prints each duplicate; exit 1 if there is one.
#   scripts/odr.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"
if ! command -v ctags >/dev/null || ! ctags --version | grep -q Universal; then
  echo "odr: error: Universal Ctags is missing; run scripts/setup.sh" >&2
  exit 2
fi

# qualified name, file and line of every definition of a class, struct, union or enum
definitions() {
  find core datasets eval bench reports \( -name '*.h' -o -name '*.cpp' \) -print0 |
    xargs -0 ctags -x --language-force=C++ --kinds-C++=csug --fields=+s --_xformat='%s::%N %F:%n' -f - |
    sed -e '/__anon/d' -e 's/^:://' | sort
}
duplicates="$(definitions | awk '$1 == name { if (!open) print previous; print; open = 1 } $1 != name { open = 0 } { name = $1; previous = $0 }')"
[[ -z "$duplicates" ]] || { echo "$duplicates"; echo "odr: the types above are defined more than once"; exit 1; }
echo "odr: clean"
