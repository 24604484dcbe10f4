#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs a command in which programs for 64-bit ARM are executed by an emulator, and can start each other, also in a chroot,
# without a change of this machine: the handler is registered in a user namespace of its own. Needs root and Linux 6.7 or newer.
#   scripts/emulate.sh EMULATOR COMMAND...      EMULATOR: a static qemu-aarch64
set -euo pipefail

# All users of this machine in the user namespace of a process, as soon as it has one.
map_users() {
  local kind
  for kind in uid gid; do
    until echo 0 0 65536 >"/proc/$1/${kind}_map"; do sleep 0.01; done 2>/dev/null
  done
}

# Programs are recognized by the first 20 bytes of an ELF file: 64 bit, little endian, executable or shared, machine 183.
register_emulator() {
  local handlers=/proc/sys/fs/binfmt_misc
  mount -t binfmt_misc binfmt_misc "$handlers"
  printf '%s' ':qemu-aarch64:M::\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00' \
    ':\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff' ":$1:PF" >"$handlers/register"
}

case "${1:-}" in
  --wait) # in the user namespace: a process becomes its root with the next program only
    until grep -q . /proc/self/uid_map && grep -q . /proc/self/gid_map; do sleep 0.01; done
    exec "$0" --emulate "${@:2}"
    ;;
  --emulate)
    register_emulator "$2"
    exec "${@:3}"
    ;;
  *)
    (($# >= 2)) || { echo "emulate: error: usage: scripts/emulate.sh EMULATOR COMMAND..." >&2; exit 2; }
    emulator="$(realpath "$1")"
    unshare --user --mount "$(realpath "$0")" --wait "$emulator" "${@:2}" <&0 &
    map_users "$!"
    wait "$!"
    ;;
esac
