#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command in a chroot, with the sources read-only at /src. With FOLDER-emulator, a static qemu-aarch64, programs for
# 64-bit ARM are executed by it (scripts/emulate.sh); FOLDER-sysroot, if it exists, is at /sysroot, and has their libraries.
# Needs root.
#   scripts/in_chroot.sh FOLDER COMMAND...
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

mount_folders() {
  local device
  # A chroot that was made under emulation has none.
  for device in null zero random urandom; do
    [[ -c "$1/dev/$device" ]] || { touch "$1/dev/$device" && mount --bind "/dev/$device" "$1/dev/$device"; }
  done
  mkdir -p "$1/src"
  mount --bind "$PWD" "$1/src" && mount -o remount,bind,ro "$1/src"
  mount -t proc proc "$1/proc"
  mount -t sysfs -o ro sysfs "$1/sys"
  [[ ! -d "$1-sysroot" ]] || { mkdir -p "$1/sysroot" && mount --bind "$1-sysroot" "$1/sysroot"; }
}

case "${1:-}" in
  --mount) # in a new mount namespace
    mount_folders "$2"
    enter=(chroot "$2" env LC_ALL=C.UTF-8 HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin)
    [[ ! -d "$2-sysroot" ]] || enter+=(QEMU_LD_PREFIX=/sysroot)
    [[ ! -e "$2-emulator" ]] || enter=(scripts/emulate.sh "$2-emulator" "${enter[@]}")
    exec "${enter[@]}" "${@:3}"
    ;;
  *)
    (($# >= 2)) || { echo "in_chroot: error: usage: scripts/in_chroot.sh FOLDER COMMAND..." >&2; exit 2; }
    exec unshare --mount "$PWD/scripts/in_chroot.sh" --mount "$(realpath "$1")" "${@:2}"
    ;;
esac
