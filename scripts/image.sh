#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes a root file system with Stillpoint, build/image/stillpoint-ARCH.tar.zst, by the steps of the Containerfile in a chroot:
# for target devices, and for container engines (podman import). Tests the program in it as its user, with data that cannot be
# written. Needs root, mmdebstrap, zstd, and the packages of scripts/package.sh.
#   scripts/image.sh amd64|arm64        arm64 under qemu-user, of scripts/portability.sh arm64
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

architecture="${1:-amd64}"
chroots="${STILLPOINT_CHROOTS:-$PWD/build/chroots}"
image="build/image/stillpoint-$architecture.tar.zst"
max_bytes=400000000
fail() { echo "image: error: $*" >&2; exit 2; }
[[ "$architecture" =~ ^(amd64|arm64)$ ]] || fail "unknown architecture \"$architecture\"; they are amd64 and arm64"
((EUID == 0)) || fail "a chroot needs root"
compgen -G "build/package-$architecture/stillpoint_*.deb" >/dev/null ||
  fail "there is no package; run scripts/package.sh $architecture"

# The base of the image: Debian without recommended packages.
make_base() {
  local mirror emulated=()
  mirror="$(apt-get indextargets --format '$(ORIGIN)|$(SITE)|$(RELEASE)' 'Origin: Debian' |
    awk -F'|' '$3 !~ /-/ { print $2; exit }')"
  [[ -n "$mirror" ]] || fail "apt has no lists of a Debian mirror; run apt-get update"
  if [[ "$architecture" == arm64 ]]; then
    ln -sf "$(realpath "$chroots/arm64-emulator")" "$1-emulator"
    emulated=(scripts/emulate.sh "$1-emulator")
  fi
  "${emulated[@]}" mmdebstrap --mode=root --variant=minbase --architectures="$architecture" --skip=check/qemu \
    bookworm "$1" "$mirror" >"$(log_file "image-$architecture")" 2>&1 || show_failure "image-$architecture"
}

# Executes the steps of the Containerfile, whose lines are joined first.
run_steps() {
  local instruction arguments
  while read -r instruction arguments; do
    case "$instruction" in
      COPY) # the source may be a pattern
        cp ${arguments%% *} "$1${arguments##* }"
        ;;
      RUN) scripts/in_chroot.sh "$1" bash -euc "$arguments" </dev/null >>"$(log_file "image-$architecture")" 2>&1 ||
        show_failure "image-$architecture" ;;
    esac
  done < <(sed -e :a -e '/\\$/N; s/\\\n//; ta' Containerfile | sed "s/\${ARCH}/$architecture/")
}

test_image() {
  local user=(setpriv --reuid 1000 --regid 1000 --clear-groups env HOME=/home/stillpoint)
  scripts/in_chroot.sh "$1" "${user[@]}" bash -euc '
    cd /work
    stillpoint --version
    stillpoint device info >/work/device
    if touch /data/x 2>/dev/null; then echo "image: error: /data is writable"; exit 1; fi
    rm /work/device'
  # Also by the libraries of the image on this system.
  local version=("$1/stillpoint" --version)
  [[ "$architecture" == amd64 ]] || version=(scripts/emulate.sh "$1-emulator" "${version[@]}")
  "${version[@]}"
}

chroot_folder="$(mktemp -d)"
trap 'rm -rf "$chroot_folder" "$chroot_folder-emulator"' EXIT
step "base and package, $architecture"
make_base "$chroot_folder"
run_steps "$chroot_folder"
step "program in the image"
test_image "$chroot_folder"
mkdir -p build/image
tar --create --zstd --numeric-owner --one-file-system --directory "$chroot_folder" --exclude='./src' --exclude='./dev/*' --file "$image" .
bytes="$(stat --format %s "$image")"
echo "image: $image: $((bytes / 1000000)) MB"
((bytes < max_bytes)) || fail "$image is larger than $((max_bytes / 1000000)) MB"
