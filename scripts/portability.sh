#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds and tests on another distribution or architecture than that of this machine, in a chroot that mmdebstrap makes
# from the Debian mirror of this machine's apt. Needs root and mmdebstrap. The chroots with their build folders remain in
# $STILLPOINT_CHROOTS (default: build/chroots), and are used again. Prints the time of each step and the sizes.
#   scripts/portability.sh debian13             Debian 13: build of the program and of the fast tests, which are run
#   scripts/portability.sh arm64                the same for 64-bit ARM: cross build (preset release-arm64); tests under
#                                               qemu-user. Before all else the SIMD kernels: same bits as on amd64
#   scripts/portability.sh TARGET STEP          only up to this step: chroot, configure, kernels, build or test
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

target="${1:-}"
last="${2:-test}"
chroots="${STILLPOINT_CHROOTS:-$PWD/build/chroots}"
jobs="${STILLPOINT_JOBS:-$(nproc)}"
folder="$chroots/$target"
fail() { echo "portability: error: $*" >&2; exit 2; }
packages() { scripts/setup.sh --list | grep -vxF -e "${1:-}" | paste -sd,; }

case "$target" in
  debian13) suite=trixie preset=release tools="$(packages)" ;;
  arm64)
    suite=bookworm preset=release-arm64
    tools=g++,g++-aarch64-linux-gnu,cmake,ninja-build,git,pkg-config,ccache,qemu-user,qemu-user-static
    # A BLAS that needs no alternatives: packages of a sysroot are only extracted.
    libraries="$(packages $'g++\ncmake\nninja-build\ngit\nmake\npkg-config\nccache\nopenimageio-tools\nuniversal-ctags'),libblas-dev,liblapack-dev"
    ;;
  *) fail "unknown target \"$target\"; the targets are debian13 and arm64" ;;
esac
[[ "$last" =~ ^(chroot|configure|kernels|build|test)$ ]] ||
  fail "unknown step \"$last\"; the steps are chroot, configure, kernels, build and test"
((EUID == 0)) || fail "a chroot needs root"
command -v mmdebstrap >/dev/null || fail "mmdebstrap is missing; run apt-get install mmdebstrap"

# The mirror of this machine's own distribution: suites with a dash are updates.
mirror="$(apt-get indextargets --format '$(ORIGIN)|$(SITE)|$(RELEASE)' 'Origin: Debian' |
  awk -F'|' '$3 !~ /-/ { print $2; exit }')"
[[ -n "$mirror" ]] || fail "apt has no lists of a Debian mirror; run apt-get update"

# make_chroot FOLDER VARIANT ARCHITECTURE PACKAGES
make_chroot() {
  local log="portability-${1##*/}"
  [[ ! -e "$1.complete" ]] || return 0
  rm -rf "$1"
  mkdir -p "$chroots"
  mmdebstrap --mode=root --variant="$2" --architectures="$3" --include="$4" \
    --aptopt='APT::Install-Recommends "false"' "$suite" "$1" "$mirror" >"$(log_file "$log")" 2>&1 || show_failure "$log"
  touch "$1.complete"
}

# Extracted packages have no alternatives: the reference BLAS and LAPACK take their place. Absolute links point outside of
# the sysroot, and a static library would be linked instead. The CMake file of Ceres names libraries by paths without it.
link_libraries() {
  local libraries="usr/lib/aarch64-linux-gnu" name target
  for name in blas lapack; do
    ln -sf "$name/lib$name.so.3" "$folder-sysroot/$libraries/lib$name.so.3"
    ln -sf "$name/lib$name.so" "$folder-sysroot/$libraries/lib$name.so"
  done
  find "$folder-sysroot/$libraries" -maxdepth 1 -type l -lname '/*' -printf '%p %l\n' | while read -r name target; do
    ln -srf "$folder-sysroot$target" "$name"
  done
  for name in blas lapack f77blas atlas; do ln -sf "/sysroot/$libraries/lib$name.so" "$folder/$libraries/lib$name.so"; done
}

chroot_step() {
  local folders=("$folder")
  make_chroot "$folder" minbase amd64 "$tools"
  if [[ "$target" == arm64 ]]; then
    make_chroot "$folder-sysroot" extract arm64 "$libraries"
    link_libraries
    ln -sf "$folder/usr/bin/qemu-aarch64-static" "$folder-emulator"
    folders+=("$folder-sysroot")
  fi
  du -shc "${folders[@]}" | tail -n 1
}
inside() { scripts/in_chroot.sh "$folder" "$@"; }
build_targets() { inside cmake --build /build --parallel "$jobs" --target "$@"; }
configure_step() { inside env STILLPOINT_SYSROOT=/sysroot cmake -S /src --preset "$preset" -B /build; }
kernels_step() { build_targets kernel_digest && inside ctest --test-dir /build --output-on-failure -R kernel_digest; }
build_step() {
  build_targets stillpoint fast_tests
  inside du -h --apparent-size /build/stillpoint
}
# Emulated tests with several threads take long.
test_step() { inside ctest --test-dir /build --output-on-failure --parallel "$jobs" -L fast --timeout 7200; }

for name in chroot configure kernels build test; do
  step "$target: $name"
  SECONDS=0
  "${name}_step"
  echo "portability: $target: $name completed in $SECONDS s"
  [[ "$last" != "$name" ]] || exit 0
done
