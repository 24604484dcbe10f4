#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes Debian packages that run on any amd64 processor, in build/package: stillpoint (program) and stillpoint-dev (static
# libraries, headers, package config, examples). STILLPOINT_CONTACT="NAME <ADDRESS>" names their maintainer.
#   scripts/package.sh         build and package
#   scripts/package.sh --test  also lintian, and installation, quick benchmark and removal in a new chroot; needs root,
#                              lintian and mmdebstrap
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

contact="${STILLPOINT_CONTACT:-The Stillpoint developers <developers@stillpoint.example.org>}"
jobs="${STILLPOINT_JOBS:-$(nproc)}"
build="build/package"
fail() { echo "package: error: $*" >&2; exit 2; }
[[ $# == 0 || ( $# == 1 && "$1" == --test ) ]] || fail "unknown option \"$*\"; the option is --test"
command -v dpkg-shlibdeps >/dev/null || fail "dpkg-dev is missing; run apt-get install dpkg-dev"

build_packages() {
  local triplet
  triplet="$(dpkg-architecture -qDEB_HOST_MULTIARCH)"
  # The kernels of the tracker select the instruction set at run time; all else uses the baseline.
  cmake --preset release -B "$build" -DSTILLPOINT_MARCH=x86-64 -DSTILLPOINT_PACKAGES=ON -DSTILLPOINT_CONTACT="$contact" \
    -DCMAKE_INSTALL_PREFIX=/usr -DSTILLPOINT_MODULE_FOLDER="lib/$triplet/stillpoint" --log-level=WARNING \
    >"$(log_file configure-package)" 2>&1 || show_failure configure-package
  cmake --build "$build" --parallel "$jobs" --target stillpoint stillpoint_module_imageio stillpoint_module_video \
    stillpoint_component_geometry stillpoint_component_core stillpoint_component_eval stillpoint_component_datasets
  scripts/package/documents.sh "$build/stillpoint" "$build/package_documents" "$contact"
  rm -f "$build"/*.deb
  (cd "$build" && cpack -G DEB) >"$(log_file cpack)" 2>&1 || show_failure cpack
  ls -l "$build"/*.deb
}

# A chroot with the libraries that the package depends on: what is left after its removal is its own.
make_chroot() {
  local mirror depends
  mirror="$(apt-get indextargets --format '$(ORIGIN)|$(SITE)|$(RELEASE)' 'Origin: Debian' |
    awk -F'|' '$3 !~ /-/ { print $2, $3; exit }')"
  [[ -n "$mirror" ]] || fail "apt has no lists of a Debian mirror; run apt-get update"
  depends="$(dpkg-deb -f "$build"/stillpoint_*.deb Depends | sed 's/ *([^)]*)//g; s/ *|[^,]*//g; s/ //g')"
  mmdebstrap --mode=root --variant=apt --include="$depends" --aptopt='APT::Install-Recommends "false"' "${mirror#* }" "$1" \
    "${mirror% *}" >"$(log_file package-chroot)" 2>&1 || show_failure package-chroot
}

test_in_chroot() {
  scripts/in_chroot.sh "$1" bash -eu -o pipefail -s -- "/src/$build" <<'INSIDE'
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
apt-get purge -q -y stillpoint >/root/log 2>&1 || { cat /root/log; exit 1; }
all_files >/root/after
if dpkg-query -W stillpoint >/dev/null 2>&1; then echo "package: still registered"; exit 1; fi
diff /root/before /root/after && echo "package: removed without a trace"
INSIDE
}

step "packages for any amd64 processor"
build_packages
[[ "${1:-}" == --test ]] || exit 0
step "lintian"
lintian --fail-on error "$build"/*.deb
step "installation in a new chroot"
((EUID == 0)) || fail "a chroot needs root"
chroot_folder="$(mktemp -d)"
trap 'rm -rf "$chroot_folder"' EXIT
make_chroot "$chroot_folder"
test_in_chroot "$chroot_folder"
