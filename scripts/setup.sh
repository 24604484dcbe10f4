#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian 12 packages that Stillpoint is built from. Asks dpkg first and does nothing when all are there.
#   scripts/setup.sh         what building, testing and running need
#   scripts/setup.sh --dev   also clang-format and clang-tidy, for scripts/check.sh, and valgrind, to count instructions
#   scripts/setup.sh --pages also a browser and LaTeX, for the tests of pages and tables that are skipped without
#   scripts/setup.sh --docs  also Doxygen and Graphviz, for scripts/docs.sh
#   scripts/setup.sh --oracles also the ROS 1 bag library of Debian, which tests compare the own reader with
#   scripts/setup.sh --cluster also Slurm, sshd, GNU parallel and rsync, for the tests of `bench --executor`; the packages
#                            start their services under systemd, which the tests do not use
#   scripts/setup.sh --python also what the Python package is built from, tested with and shown with; it is left out without
#   scripts/setup.sh --minimal only what the preset "minimal" needs, e.g. on a device; with --list its names
#   scripts/setup.sh --list  only prints the names of the packages that building, testing and running need
#   scripts/setup.sh --all   all of these, as CI does: no test is skipped for want of a package
set -euo pipefail

minimal=(
  g++ cmake ninja-build git pkg-config
  libeigen3-dev libceres-dev libsuitesparse-dev
  libopencv-dev
  libhwy-dev
  libopenimageio-dev libisal-dev libturbojpeg0-dev libblosc-dev
  libfmt-dev libspdlog-dev libcli11-dev
  nlohmann-json3-dev libyaml-cpp-dev libtomlplusplus-dev
)
packages=(
  "${minimal[@]}"
  make ccache mold
  openimageio-tools libbz2-dev liblz4-dev
  libembree-dev libtbb-dev libassimp-dev
  libsqlite3-dev libzstd-dev libmicrohttpd-dev libpango1.0-dev fonts-liberation
  libcurl4-openssl-dev libarchive-dev libssl-dev libproj-dev
  libgtest-dev libbenchmark-dev
  universal-ctags
)
dev=(clang-format clang-tidy valgrind)
pages=(chromium texlive-latex-recommended)
{ command -v node && command -v npm; } >/dev/null || pages+=(nodejs npm)
docs=(doxygen graphviz)
oracles=(python3-rosbag python3-sensor-msgs python3-geometry-msgs python3-nav-msgs python3-tf2-msgs)
python=(pybind11-dev python3-dev python3-venv python3-numpy python3-pytest python3-pandas python3-matplotlib)
cluster=(munge slurm-wlm openssh-server parallel rsync zstd)
if [[ "${1:-}" == --minimal ]]; then
  packages=("${minimal[@]}")
  shift
fi
case "${1:-}" in
  "") ;;
  --list) printf '%s\n' "${packages[@]}"; exit 0 ;;
  --dev) packages+=("${dev[@]}") ;;
  --pages) packages+=("${pages[@]}") ;;
  --docs) packages+=("${docs[@]}") ;;
  --oracles) packages+=("${oracles[@]}") ;;
  --python) packages+=("${python[@]}") ;;
  --cluster) packages+=("${cluster[@]}") ;;
  --all) packages+=("${dev[@]}" "${pages[@]}" "${docs[@]}" "${oracles[@]}" "${cluster[@]}" "${python[@]}") ;;
  *) echo "setup: error: unknown option \"$1\"; the options are --minimal, --dev, --pages, --docs, --oracles, --cluster, --python, --list and --all" >&2; exit 2 ;;
esac

is_installed() { [[ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]; }

if ! command -v dpkg-query apt-get >/dev/null; then
  echo "setup: error: this is not a Debian system; install the counterparts of: ${packages[*]}" >&2
  exit 1
fi
missing=()
for package in "${packages[@]}"; do is_installed "$package" || missing+=("$package"); done
if ((${#missing[@]} == 0)); then
  echo "setup: all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "setup: error: installing needs root, and there is no sudo; as root run: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y "$@"; }

echo "setup: installing ${#missing[@]} packages: ${missing[*]}"
apt update || { echo "setup: the package lists could not be fetched; trying once more"; sleep 5; apt update; }
apt install --no-install-recommends "${missing[@]}"
