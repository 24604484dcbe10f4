#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks what of CONTRIBUTING.md a few patterns can check: licence lines, sizes of files, functions and folders, numbers of
# parameters, include guards, and words that are not to be in sources. Prints each fault as a file; exit 1 if there is one.
#   scripts/style.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"

faults=0
report() { # faults on the standard input
  while read -r fault; do
    echo "$fault"
    faults=$((faults + 1))
  done
}
complain() { report < <(sed "s|\$|: $1|"); } # TEXT, files on the standard input
if ! command -v ctags >/dev/null || ! ctags --version | grep -q Universal; then
  echo "style: error: Universal Ctags is missing; run scripts/setup.sh" >&2
  exit 2
fi

# Functions with more than 60 lines or, in the program, 4 parameters: file:line, name and fault. Unnamed parameters,
# which callbacks of C libraries have, do not count, nor do those of bindings: they are keyword arguments of Python.
large_functions() {
  find core datasets eval bench reports tests \( -name '*.h' -o -name '*.cpp' \) -print0 |
    xargs -0 --no-run-if-empty ctags -x --language-force=C++ --kinds-C++=f --fields=+neS \
      --_xformat='%{end} %n %F %N %S' -f - |
    awk '
      function is_named(parameter) {
        sub(/=.*/, "", parameter)
        gsub(/\[[^]]*\]|\([^)]*\)|<.*>/, "", parameter)
        return parameter ~ /[A-Za-z0-9_&*>: ][ &*][A-Za-z_][A-Za-z0-9_]* *$/
      }
      $1 - $2 + 1 > 60 { print $3 ":" $2 " " $4 ": more than 60 lines" }
      $3 ~ /^(tests|bench\/python)\// { next }
      {
        text = $0
        sub(/^[^(]*\(/, "", text)
        depth = count = 0
        parameter = ""
        for (i = 1; i <= length(text); ++i) {
          letter = substr(text, i, 1)
          if (letter ~ /[(<{[]/) ++depth
          if (letter ~ /[>}\]]/ || (letter == ")" && depth > 0)) --depth
          else if (letter ~ /[,)]/ && depth == 0) {
            count += is_named(parameter)
            parameter = ""
            if (letter == ")") break
            continue
          }
          parameter = parameter letter
        }
        if (count > 4) print $3 ":" $2 " " $4 ": more than 4 parameters"
      }' | sort
}
sources() { find core datasets eval bench reports tests -name '*.h' -o -name '*.cpp' | sort; }

report < <(sources | xargs --no-run-if-empty awk '
  FNR == 1 && !/SPDX-License-Identifier: BSD-3-Clause/ { print FILENAME ": no SPDX line at the top" }
  FNR == 601 { print FILENAME ": more than 600 lines" }')
complain "no #pragma once" < <(sources | grep '\.h$' | xargs --no-run-if-empty grep -L '^#pragma once$' || true)
complain "using namespace at file scope" < <(sources | xargs grep -l '^using namespace ' || true)
complain "TODO without an issue" < <(sources | xargs grep -lE 'TODO($|[^(]|\([^#])|FIXME' || true)

report < <(large_functions)
report < <(sources | grep -v '^tests/' | xargs --no-run-if-empty -n1 dirname | sort | uniq -c |
  awk '$1 > 20 { print $2 ": more than 20 files" }')

# A test that no target contains is never executed. A target without SOURCES, or with those of a GLOB, takes all.
unlisted_tests() {
  find tests -name CMakeLists.txt | sort | while read -r list; do
    awk 'BEGIN { RS = "stillpoint_test\\(" } /GLOB/ || (NR > 1 && !/SOURCES/) { all = 1 } END { exit NR < 2 || all }' "$list" || continue
    for test in "${list%/*}"/*_test.cpp; do
      [[ ! -e "$test" ]] || grep -qF -- "${test##*/}" "$list" || echo "$test"
    done
  done
}
complain "no test program contains it" < <(unlisted_tests)

((faults == 0)) || { echo "style: $faults fault(s)"; exit 1; }
echo "style: clean"
