#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Plants a type that is defined twice and expects scripts/odr.sh to report both places.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

two_definitions() { # FIRST SECOND
  empty_tree
  put core/types/a.h "$1"
  put eval/metrics/a.cpp "$2"
}
two_definitions 'namespace stillpoint { struct Track { int id; }; }' 'namespace stillpoint { struct Track { double t; }; }'
expect_fault odr.sh "stillpoint::Track core/types/a.h:1" "a struct defined twice"
expect_fault odr.sh "stillpoint::Track eval/metrics/a.cpp:1" "the second definition"
two_definitions 'namespace stillpoint { enum class Place { kA }; }' 'namespace stillpoint { class Place { int x; }; }'
expect_fault odr.sh "stillpoint::Place" "an enum and a class of one name"
two_definitions 'namespace stillpoint { struct Track { int id; }; }' 'namespace stillpoint::eval { struct Track { double t; }; }'
expect_clean odr.sh "one name in two namespaces"
two_definitions 'namespace stillpoint { struct Track { int id; }; }' 'namespace stillpoint { struct Track; }'
expect_clean odr.sh "a forward declaration"
two_definitions 'namespace stillpoint { namespace { struct Track { int id; }; } }' 'namespace stillpoint { namespace { struct Track { double t; }; } }'
expect_clean odr.sh "types in unnamed namespaces"
finish
