#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# CITATION.cff must carry the version of the root CMakeLists.txt.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

version="$(sed -nE 's/^project\(stillpoint VERSION ([0-9.]+).*/\1/p' "$root/CMakeLists.txt")"
cited="$(sed -nE 's/^version: *//p' "$root/CITATION.cff")"
[[ -n "$version" ]] || fail "no version found in CMakeLists.txt"
[[ "$cited" == "$version" ]] || fail "CITATION.cff has version \"$cited\", CMakeLists.txt has \"$version\""
finish
