#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets the machine up, builds the program, and runs the quick benchmark on sequences that it renders itself.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

step "packages"
scripts/setup.sh

step "program (release build)"
configure release
build release stillpoint

step "quick benchmark"
build/release/stillpoint bench quick "$@"
