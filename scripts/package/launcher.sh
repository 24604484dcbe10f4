#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs Stillpoint of an extracted root file system (scripts/image.sh) on another system, with the libraries beside it, also the C
# library and its loader: needs no container engine, and no rights. At the root of that file system.
#   FOLDER/stillpoint ...
launcher="$(readlink -f "$0")"
for libraries in "${launcher%/*}"/usr/lib/*-linux-gnu; do
  # The loader is the running executable then; children are started by this script again.
  export STILLPOINT_LAUNCHER="$launcher"
  exec "$libraries"/ld-linux-*.so.* --library-path "$libraries:$libraries/stillpoint:$libraries/blas:$libraries/lapack" \
    "${launcher%/*}/usr/bin/stillpoint" "$@"
done
