#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets the machine up, builds the program, runs the quick benchmark on sequences that it renders itself, and writes its page.
#   demo.sh [--minimal]     --minimal: only packages and program of the minimal build, which has no renderer, bags and pages
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
case "${1:-}" in
  "") preset=release ;;
  --minimal) preset=minimal ;;
  *)
    echo "demo.sh: unknown argument \"$1\": only --minimal is known" >&2
    exit 2
    ;;
esac

step "packages"
if [[ $preset == minimal ]]; then scripts/setup.sh --minimal; else scripts/setup.sh; fi

step "program ($preset build)"
configure $preset
build $preset stillpoint
program="build/$preset/stillpoint"

if [[ $preset == minimal ]]; then
  step "next"
  echo "$program run FOLDER --out out               # a sequence of your own, see datasets/README.md"
  exit
fi

step "quick benchmark"
store=build/bench/store.sqlite page=build/bench/page
"$program" bench quick --store $store

step "page"
"$program" report $store --out $page
cat <<NEXT
$PWD/$page/index.html shows these runs. Next:
  $program run walking_xyz --seconds 5 --out out
  $program eval walking_xyz out --plot path.svg
  cmake --install build/$preset --prefix ~/.local --component program
NEXT
