#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds and tests on another distribution or architecture than that of this machine, in a chroot that mmdebstrap makes
# from the Debian mirror of this machine's apt. Needs root, mmdebstrap, and for arm64 also qemu-user. The chroots remain in
# $STILLPOINT_CHROOTS (default: build/chroots), and are used again.
#   scripts/portability.sh debian13             Debian 13: configure, build the program, run the fast tests
#   scripts/portability.sh debian13 configure   only up to this step; the steps are chroot, configure, build, test
#   scripts/portability.sh arm64                cross build of the SIMD kernels for 64-bit ARM, and their test under
#                                               qemu-user: same bits as on amd64. The rest of the project is not built yet
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

target="${1:-}"
last="${2:-test}"
root="$PWD"
chroots="${STILLPOINT_CHROOTS:-$root/build/chroots}"
jobs="${STILLPOINT_JOBS:-$(nproc)}"
fail() { echo "portability: error: $*" >&2; exit 2; }

case "$target" in
  debian13)
    suite=trixie architectures=amd64
    packages="$(scripts/setup.sh --list | paste -sd,)"
    configure=(-S /src --preset release)
    build=(--target stillpoint fast_tests)
    tests=(-L fast)
    ;;
  arm64)
    suite=bookworm architectures=amd64,arm64
    packages=g++,g++-aarch64-linux-gnu,libc6-dev:arm64,libhwy-dev:arm64,cmake,ninja-build,qemu-user
    configure=(-S /src/tests/kernel_digest -G Ninja -DCMAKE_BUILD_TYPE=Release --toolchain /src/scripts/cmake/aarch64.cmake)
    build=()
    tests=()
    ;;
  *) fail "unknown target \"$target\"; the targets are debian13 and arm64" ;;
esac
[[ "$last" =~ ^(chroot|configure|build|test)$ ]] || fail "unknown step \"$last\"; the steps are chroot, configure, build and test"
((EUID == 0)) || fail "a chroot needs root"
command -v mmdebstrap >/dev/null || fail "mmdebstrap is missing; run apt-get install mmdebstrap"

# The mirror of this machine's own distribution: suites with a dash are updates.
mirror="$(apt-get indextargets --format '$(ORIGIN)|$(SITE)|$(RELEASE)' 'Origin: Debian' |
  awk -F'|' '$3 !~ /-/ { print $2; exit }')"
[[ -n "$mirror" ]] || fail "apt has no lists of a Debian mirror; run apt-get update"

chroot_folder="$chroots/$target"
make_chroot() {
  [[ -e "$chroot_folder/.complete" ]] && return
  rm -rf "$chroot_folder"
  mkdir -p "$chroots"
  mmdebstrap --mode=root --variant=minbase --architectures="$architectures" --include="$packages" \
    --aptopt='APT::Install-Recommends "false"' "$suite" "$chroot_folder" "$mirror" >"$(log_file "$target-chroot")" 2>&1 ||
    show_failure "$target-chroot"
  touch "$chroot_folder/.complete"
}

# inside COMMAND...: runs it in the chroot, with the sources read-only at /src.
inside() {
  mkdir -p "$chroot_folder/src"
  unshare -m bash -euc '
    mount --bind "$1" "$2/src" && mount -o remount,bind,ro "$2/src" && mount -t proc proc "$2/proc"
    folder=$2; shift 2
    exec chroot "$folder" env LC_ALL=C.UTF-8 HOME=/root "$@"' _ "$root" "$chroot_folder" "$@"
}

until_step() { [[ "$last" != "$1" ]] || { echo "portability: $target: $1 completed"; exit 0; }; }

step "$target: chroot"
make_chroot
until_step chroot
step "$target: configure"
inside cmake "${configure[@]}" -B /build
until_step configure
step "$target: build"
inside cmake --build /build --parallel "$jobs" "${build[@]}"
until_step build
step "$target: test"
inside ctest --test-dir /build --output-on-failure "${tests[@]}"
