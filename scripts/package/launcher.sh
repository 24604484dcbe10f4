#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs Stillpoint of an extracted root file system (scripts/image.sh) on another system, with the libraries beside it, also the C
# library and its loader: needs no container engine, and no rights. At the root of that file system.
#   FOLDER/stillpoint ...
launcher="$(readlink -f "$0")"
root="${launcher%/*}"
for libraries in "$root"/usr/lib/*-linux-gnu; do
  path="$libraries:$libraries/stillpoint"
  # BLAS and LAPACK are chosen by links that are absolute, and could lead to those of this system.
  for link in "$root"/etc/alternatives/lib*.so.3-"${libraries##*/}"; do
    [ ! -L "$link" ] || path="$root$(dirname "$(readlink "$link")"):$path"
  done
  # The database of coordinate reference systems; PROJ looks for it at the root of this system.
  [ -n "$PROJ_DATA" ] || [ ! -d "$root/usr/share/proj" ] || export PROJ_DATA="$root/usr/share/proj"
  # The loader is the running executable then; children are started by this script again.
  export STILLPOINT_LAUNCHER="$launcher"
  exec "$libraries"/ld-linux-*.so.* --inhibit-cache --library-path "$path" "$root/usr/bin/stillpoint" "$@"
done
