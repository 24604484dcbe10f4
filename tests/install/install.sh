#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the build folder BUILD to PREFIX and runs the installed program.
#   install.sh CMAKE BUILD PREFIX
set -euo pipefail
cmake="$1" build="$2" prefix="$3"

rm -rf "$prefix"
"$cmake" --install "$build" --prefix "$prefix" >"$build/install.log" || { cat "$build/install.log"; exit 1; }
"$prefix/bin/stillpoint" --help >/dev/null
# After demo.sh only the program is built; its component needs no other target.
"$cmake" --install "$build" --prefix "$prefix.program" --component program >>"$build/install.log"
"$prefix.program/bin/stillpoint" --help >/dev/null
for file in share/man/man1/stillpoint.1.gz share/bash-completion/completions/stillpoint share/stillpoint/LICENSE; do
  [[ -s "$prefix.program/$file" ]] || { echo "$file is not installed with the program"; exit 1; }
done
zgrep -q 'stillpoint trajectory convert' "$prefix.program/share/man/man1/stillpoint.1.gz"
rm -rf "$prefix.program"

# An include that was not rewritten would be found in the sources of this machine, but not on another.
if grep -rnE '#include "(core|eval|datasets|bench)/' "$prefix/include" "$prefix/share"; then
  echo "the installed files above include paths of the source tree"
  exit 1
fi
sources="$(cd "$(dirname "$0")/../.." && pwd)"
if grep -rnF -e '-march' -e '-Werror' -e "$sources" "$prefix/lib/cmake"; then
  echo "the package config above exports compiler flags or paths of this machine"
  exit 1
fi
