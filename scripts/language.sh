#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Finds names and phrases that the project does not use, in sources, documents and the help of the program: one concept
# has one name, the standard term of the field. Prints each as file:line with the term to use; exit 1 if there is one.
#   scripts/language.sh [ROOT [PROGRAM]]
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/..}"
program="${2:-}"

# Perl regular expression (letters of either case match, except in lookarounds) => the term to use
rules=(
  'pictures?(?![a-z])|picture_|_picture => image (pixels) or frame (time-stamped message)'
  'sightings? => observation'
  'verdicts? => label, change class, result'
  '(?<![a-z])judg(e|ed|es|ing|ement|ements)(?![a-z]) => classify, assess'
  '(?<![a-z])recipes?(?![a-z])(?!.*alias) => evaluation protocol'
  '(?<![a-z])boards?(?![a-z]) => target device'
  '(?<![a-z])journals?(?![a-z])(?!.*(of Field|IEEE|International)) => store writer'
  '(?<!device )(?<!kernel )(?<!chromium-)(?<![a-z])drivers?(?![a-z]) => worker (the process that executes a plan)'
  '(?<![a-z])mattes?(?![a-z]) => instance mask'
  '(?<![a-z])(flights?|flown|flew)(?![a-z])|in flight => trajectory, recorded motion; steady state'
  'to and fro|to_and_fro => ping-pong playback'
  '(?<![a-z])doctors?(?![a-z]) => validator'
  '(?<![a-z])misfits?(?![a-z])|misfit_ => reprojection error'
  '(?<![a-z])creep(s|ing)?(?![a-z]) => drift over commits'
  '(?<![a-z])begun(?![a-z]) => initialized, started'
  'the house|plan of the house => codebase'
  'asks? for (no )?memory|asking for memory => allocates'
  'ended well|gone wrong|went wrong => succeeded, failed'
  '[a-z]_share(?![a-z]) => _ratio or _fraction'
  '(const |[a-z>] |& |&& )memory(\)|,| =) => scratch, buffer'
  '(?<![a-z])spare_|SpareVectors|KeptMatrix => pool, reusable'
  '(?<![a-z])at hand(?![a-z]) => available'
  'who takes part|whoever|(?<![a-z])nobody(?![a-z]) => (name the component)'
  'is (not )?believed|held to (move|be) => accepted, classified as'
  '(pictures|frames|times|steps) a second => per second'
  'runs? (was|were|are|is) (made|kept)(?! (of|in|as|for|by))|(?<![a-z])made anew => executed, cached, rebuilt'
  'names[_ ]apart|barren => disambiguate, empty'
  'what .* (says|said|tells|hears) of|hears => (state the content)'
)
# Extended regular expression over "file:line:text": names in old stores and in other people's formats, and correct English
allowed=(
  '^bench/store/schema\.cpp:.*(recipe|picture:|journal|driver)'
  '^tests/unit/store/schema_test\.cpp:'
  '^(bench/cli|tests)/.*--recipe'
  'sys/bus/i2c/drivers|sensor drivers'
  '"Nobody inspects|"nobody"'
  # keys of rendering requests and one preset, which are part of the identity of rendered sequences in stores
  '"((dropped|depth\.correlated|correlated|detector\.miss|miss|jitter|false)_share|flight)"|synth\.dropped_share|[Pp]reset `?flight|preset \\"flight|`flight`|synth flight |; flight"'
  '^datasets/catalogue/.*journal = '  # BibTeX
  '^CHANGELOG\.md:[0-9]+:\|.*->'
)
files() {
  git ls-files -c -o --exclude-standard -- '*.h' '*.cpp' '*.in' '*.sh' '*.js' '*.mjs' '*.css' '*.html' '*.toml' '*.md' '*.cmake' '*.txt' '*.yml' '*.cff' 2>/dev/null |
    grep -vE '^(reports/web/vendor/|reports/published/|scripts/language\.sh|tests/repo/language_test\.sh)' ||
    find . -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.md' \) | sed 's|^\./||'
}
# help_text: the help of the program and of each of its subcommands, each line after the command that prints it
help_text() {
  [[ -n "$program" ]] || return 0
  "$program" --help | sed 's/^/--help: /'
  "$program" --help | sed -nE 's/^  ([a-z]+) .*/\1/p' | while read -r command; do
    "$program" "$command" --help 2>/dev/null | sed "s/^/$command --help: /"
  done
}

found=0
exceptions="$(IFS="|"; echo "${allowed[*]}")"
list="$(files)"
help="$(help_text)"
for rule in "${rules[@]}"; do
  pattern="$(sed 's/\[a-z\])/(?-i:[a-z]))/g' <<<"${rule% => *}")"
  hits="$( { printf '%s\n' "$list" | xargs -d '\n' grep -sHnPi -- "$pattern" || true; grep -Pi -- "$pattern" <<<"$help" || true; } | grep -vE "$exceptions" || true)"
  [[ -n "$hits" ]] || continue
  sed "s|\$|    [use: ${rule##* => }]|" <<<"$hits"
  found=$((found + $(wc -l <<<"$hits")))
done
((found == 0)) || { echo "language: $found line(s)"; exit 1; }
echo "language: clean"
