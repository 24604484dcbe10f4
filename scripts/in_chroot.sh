#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command in a chroot, with the sources read-only at /src, and FOLDER-sysroot, if it exists, at /sysroot: programs
# for 64-bit ARM are then executed by the chroot's qemu-user with the libraries of /sysroot, and can start each other, without
# a change of this machine (the handler is registered in a user namespace of its own; Linux 6.7 or newer). Needs root.
#   scripts/in_chroot.sh FOLDER COMMAND...
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

enter() { exec chroot "$1" env LC_ALL=C.UTF-8 HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin "${@:2}"; }

mount_folders() {
  mkdir -p "$1/src"
  mount --bind "$PWD" "$1/src" && mount -o remount,bind,ro "$1/src"
  mount -t proc proc "$1/proc"
  mount -t sysfs -o ro sysfs "$1/sys"
  [[ ! -d "$1-sysroot" ]] || { mkdir -p "$1/sysroot" && mount --bind "$1-sysroot" "$1/sysroot"; }
}

# Programs are recognized by the first 20 bytes of an ELF file: 64 bit, little endian, executable or shared, machine 183.
register_emulator() {
  local handlers="$1/proc/sys/fs/binfmt_misc"
  mount -t binfmt_misc binfmt_misc "$handlers"
  printf '%s' ':qemu-aarch64:M::\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00' \
    ':\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff' \
    ":$1/usr/bin/qemu-aarch64:PF" >"$handlers/register"
}

case "${1:-}" in
  --mount) # in a new mount namespace
    mount_folders "$2"
    [[ -d "$2-sysroot" ]] && exec unshare --user --map-root-user --mount "$PWD/scripts/in_chroot.sh" --emulate "${@:2}"
    enter "${@:2}"
    ;;
  --emulate) # in a new user namespace
    register_emulator "$2"
    enter "$2" env QEMU_LD_PREFIX=/sysroot "${@:3}"
    ;;
  *)
    (($# >= 2)) || { echo "in_chroot: error: usage: scripts/in_chroot.sh FOLDER COMMAND..." >&2; exit 2; }
    exec unshare --mount "$PWD/scripts/in_chroot.sh" --mount "$(realpath "$1")" "${@:2}"
    ;;
esac
