#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes Debian packages: stillpoint (program), stillpoint-dev (static libraries, headers, package config, examples) and, for
# amd64 with the packages of scripts/setup.sh --python, python3-stillpoint.
# STILLPOINT_CONTACT="NAME <ADDRESS>" names their maintainer.
#   scripts/package.sh amd64         build and package for any amd64 processor, in build/package-amd64
#   scripts/package.sh arm64         same for 64-bit ARM, by the cross compiler of scripts/portability.sh; after amd64
#   scripts/package.sh ARCH --test   also lintian, and installation, quick benchmark and removal in a new chroot; arm64 under
#                                    qemu-user. Needs root, lintian and mmdebstrap
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

contact="${STILLPOINT_CONTACT:-The Stillpoint developers <developers@stillpoint.example.org>}"
chroots="${STILLPOINT_CHROOTS:-$PWD/build/chroots}"
jobs="${STILLPOINT_JOBS:-$(nproc)}"
architecture="${1:-amd64}"
packages="build/package-$architecture"
fail() { echo "package: error: $*" >&2; exit 2; }
dependencies() { dpkg-deb -f "$1"/stillpoint_*.deb Depends; }
# Of the program and, if it is made, the Python package, without this project's own.
all_dependencies() {
  dependencies "$1"
  [[ ! -e "$(echo "$1"/python3-stillpoint_*.deb)" ]] || dpkg-deb -f "$1"/python3-stillpoint_*.deb Depends
}

# The kernels of the tracker select the instruction set at run time; all else uses the baseline.
case "$architecture" in
  amd64)
    inside=() sources="$PWD" build="$PWD/build/package"
    options=(--preset release -DSTILLPOINT_MARCH=x86-64 -DSTILLPOINT_MODULE_FOLDER=lib/x86_64-linux-gnu/stillpoint)
    ;;
  arm64) # the libraries have the same names as for amd64, whose dependencies dpkg-shlibdeps finds
    inside=(scripts/in_chroot.sh "$chroots/arm64" env STILLPOINT_SYSROOT=/sysroot) sources=/src build=/build-package
    options=(--preset release-arm64 -DSTILLPOINT_MODULE_FOLDER=lib/aarch64-linux-gnu/stillpoint)
    compgen -G "build/package-amd64/stillpoint_*.deb" >/dev/null || fail "the packages for amd64 are made first"
    options+=("-DSTILLPOINT_PACKAGE_DEPENDS=$(dependencies build/package-amd64)")
    ;;
  *) fail "unknown architecture \"$architecture\"; they are amd64 and arm64" ;;
esac
[[ $# -le 1 || ( $# == 2 && "$2" == --test ) ]] || fail "unknown option \"${*:2}\"; the option is --test"
command -v dpkg-shlibdeps >/dev/null || fail "dpkg-dev is missing; run apt-get install dpkg-dev"

# The Python package, unless it is left out; the configuration prints why.
python_target() {
  "${inside[@]}" cmake --build "$build" --target help | grep -o '^stillpoint_python\b' | head -n 1 || true
}

build_packages() {
  local python
  [[ "$architecture" == amd64 ]] || scripts/portability.sh arm64 chroot
  "${inside[@]}" cmake -S "$sources" -B "$build" "${options[@]}" -DSTILLPOINT_PACKAGES=ON "-DSTILLPOINT_CONTACT=$contact" \
    -DCMAKE_INSTALL_PREFIX=/usr --log-level=WARNING >"$(log_file "configure-package-$architecture")" 2>&1 ||
    show_failure "configure-package-$architecture"
  mapfile -t python < <(python_target)
  "${inside[@]}" cmake --build "$build" --parallel "$jobs" --target stillpoint stillpoint_module_imageio \
    stillpoint_module_drawing stillpoint_module_video stillpoint_component_geometry stillpoint_component_core stillpoint_component_eval \
    stillpoint_component_datasets stillpoint_component_config "${python[@]}"
  "${inside[@]}" "$sources/scripts/package/documents.sh" "$build/stillpoint" "$build/package_documents" "$contact"
  "${inside[@]}" bash -c 'cd "$1" && rm -f *.deb && cpack -G DEB' - "$build" >"$(log_file "cpack-$architecture")" 2>&1 ||
    show_failure "cpack-$architecture"
  rm -rf "$packages"
  mkdir -p "$packages"
  if [[ "$architecture" == amd64 ]]; then cp "$build"/*.deb "$packages"; else cp "$chroots/arm64$build"/*.deb "$packages"; fi
  ls -l "$packages"/*.deb
}

# A chroot with the libraries that the package depends on: what is left after its removal is its own.
make_chroot() {
  local mirror depends emulated=()
  mirror="$(apt-get indextargets --format '$(ORIGIN)|$(SITE)|$(RELEASE)' 'Origin: Debian' |
    awk -F'|' '$3 !~ /-/ { print $2, $3; exit }')"
  [[ -n "$mirror" ]] || fail "apt has no lists of a Debian mirror; run apt-get update"
  depends="$(all_dependencies "$packages" | tr ',' '\n' | sed 's/ *([^)]*)//g; s/ *|.*//; s/ //g' | grep -v '^stillpoint$' | sort -u | paste -sd,)"
  if [[ "$architecture" == arm64 ]]; then
    ln -sf "$(realpath "$chroots/arm64-emulator")" "$1-emulator"
    emulated=(scripts/emulate.sh "$1-emulator")
  fi
  "${emulated[@]}" mmdebstrap --mode=root --variant=apt --architectures="$architecture" --skip=check/qemu \
    --include="$depends" --aptopt='APT::Install-Recommends "false"' "${mirror#* }" "$1" "${mirror% *}" \
    >"$(log_file "package-chroot-$architecture")" 2>&1 || show_failure "package-chroot-$architecture"
}

# An emulated renderer takes an hour: sequences are rendered by this machine, into the cache of the user in the chroot.
render() {
  local sequence
  for sequence in walking_xyz_empty walking_rpy_empty walking_xyz; do
    STILLPOINT_CACHE="$1/root/.cache/stillpoint" build/package/stillpoint data synth "$sequence" --seconds 8
  done
}

test_in_chroot() {
  scripts/in_chroot.sh "$1" bash -eu -o pipefail -s -- "/src/$packages" <<'INSIDE'
# Without the home of the user, who keeps the runs, and the lists and logs of the package manager.
all_files() {
  local excluded=(/proc /sys /src /tmp /root /var/cache /var/log /var/lib/apt /var/lib/dpkg)
  find / -xdev \( -false $(printf -- " -o -path %s" "${excluded[@]}") \) -prune -o -print | sort
}
all_files >/root/before
apt-get install -q -y "$1"/stillpoint_*.deb >/root/log 2>&1 || { cat /root/log; exit 1; }
stillpoint --version
stillpoint device info | head -n 3
mkdir /root/runs
cd /root/runs
stillpoint bench quick
purged=(stillpoint)
if [[ -e "$(echo "$1"/python3-stillpoint_*.deb)" ]]; then
  purged+=(python3-stillpoint)
  apt-get install -q -y "$1"/python3-stillpoint_*.deb >/root/log 2>&1 || { cat /root/log; exit 1; }
  python3 -c 'from stillpoint import Odometry, datasets, eval, store, synth; print(Odometry, len(synth.preset_names()), "presets")'
  for i in {1..40}; do echo "$i.0 $((i * i)) $i 0 0 0 0 1"; done >poses.tum
  python3 /usr/share/doc/python3-stillpoint/examples/score_files.py poses.tum poses.tum
fi
apt-get purge -q -y "${purged[@]}" >/root/log 2>&1 || { cat /root/log; exit 1; }
all_files >/root/after
if dpkg-query -W stillpoint >/dev/null 2>&1; then echo "package: still registered"; exit 1; fi
diff /root/before /root/after && echo "package: removed without a trace"
INSIDE
}

step "packages for $architecture"
build_packages
[[ "${2:-}" == --test ]] || exit 0
step "lintian"
lintian --fail-on error "$packages"/*.deb
step "installation in a new chroot"
((EUID == 0)) || fail "a chroot needs root"
chroot_folder="$(mktemp -d)"
trap 'rm -rf "$chroot_folder" "$chroot_folder-emulator"' EXIT
make_chroot "$chroot_folder"
[[ "$architecture" == amd64 ]] || render "$chroot_folder"
test_in_chroot "$chroot_folder"
