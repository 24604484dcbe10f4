#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds and tests on another distribution or architecture than that of this machine, in a chroot that mmdebstrap makes
# from the Debian mirror of this machine's apt. Needs root, mmdebstrap, and for arm64 also qemu-user. The chroots remain in
# $STILLPOINT_CHROOTS (default: build/chroots), and are used again.
#   scripts/portability.sh debian13             Debian 13: configure, build the program, run the fast tests
#   scripts/portability.sh debian13 configure   only up to this step; the steps are chroot, configure, build, test
#   scripts/portability.sh arm64                cross build for 64-bit ARM, tests under qemu-user; same steps
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

target="${1:-}"
last="${2:-test}"
root="$PWD"
chroots="${STILLPOINT_CHROOTS:-$root/build/chroots}"
jobs="${STILLPOINT_JOBS:-$(nproc)}"
fail() { echo "portability: error: $*" >&2; exit 2; }

case "$target" in
  debian13) suite=trixie preset=release tests=(fast_tests) ;;
  # The kernels that must give the same bits on all processors, and what needs no other library.
  arm64) suite=bookworm preset=release-arm64 tests=(patch_kernel_test) ;;
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
packages=()
while read -r package; do packages+=("$package"); done < <(scripts/setup.sh --list)

make_chroot() {
  [[ -e "$chroot_folder/.complete" ]] && return
  rm -rf "$chroot_folder"
  mkdir -p "$chroots"
  local options=(--mode=root --variant=minbase --aptopt='APT::Install-Recommends "false"')
  local list
  if [[ "$target" == arm64 ]]; then
    # Tools of this machine's architecture, libraries of the other one.
    options+=(--architectures=amd64,arm64)
    list="crossbuild-essential-arm64,cmake,ninja-build,pkg-config,git,qemu-user,libhwy-dev:arm64,libgtest-dev:arm64,libopencv-dev:arm64,libeigen3-dev"
  else
    list="$(IFS=,; echo "${packages[*]}")"
  fi
  mmdebstrap "${options[@]}" --include="$list" "$suite" "$chroot_folder" "$mirror" >"$(log_file "$target-chroot")" 2>&1 ||
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
inside cmake -S /src --preset "$preset" -B /build
until_step configure
step "$target: build"
targets=("${tests[@]}")
[[ "$target" == arm64 ]] || targets+=(stillpoint)
inside cmake --build /build --parallel "$jobs" --target "${targets[@]}"
until_step build
step "$target: test"
case "$target" in
  arm64) inside ctest --test-dir /build --output-on-failure -R "^($(IFS='|'; echo "${tests[*]}"))\$" ;;
  *) inside ctest --test-dir /build --output-on-failure -L fast ;;
esac
