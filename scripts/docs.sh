#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Generates the reference of the public headers with Doxygen, in build/docs/html. Fails on any warning.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
if ! command -v doxygen >/dev/null; then
  echo "docs: error: doxygen is missing; run scripts/setup.sh --docs" >&2
  exit 2
fi

headers="$(cmake -P scripts/cmake/public_headers.cmake)"
version="$(sed -nE 's/^project\(stillpoint VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)"
mkdir -p build/docs
{
  cat scripts/docs/Doxyfile
  echo "PROJECT_NUMBER = $version"
  echo "INPUT = scripts/docs/main_page.md ${headers//$'\n'/ }"
} | doxygen -
echo "docs: $(wc -l <<<"$headers") headers; open build/docs/html/index.html"
