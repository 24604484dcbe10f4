# SPDX-License-Identifier: BSD-3-Clause
# bash completion of stillpoint: subcommands and options, as its help lists them; else files.

# _stillpoint_words SUBCOMMAND...: the subcommands and options that this help lists, one a line.
_stillpoint_words() {
  stillpoint "$@" --help 2>/dev/null | awk '
    /^[A-Z]/ { section = $1; next }
    section == "Subcommands:" && /^  [a-z]/ { print $1 }
    section == "Options:" && /^  -/ { count = split($1, names, ","); for (i = 1; i <= count; ++i) print names[i] }'
}

_stillpoint() {
  local word="${COMP_WORDS[COMP_CWORD]}" subcommands=() i
  for ((i = 1; i < COMP_CWORD && i < 3; ++i)); do
    [[ "${COMP_WORDS[i]}" == [a-z]* ]] || break
    _stillpoint_words "${subcommands[@]}" | grep -qxF -- "${COMP_WORDS[i]}" || break
    subcommands+=("${COMP_WORDS[i]}")
  done
  mapfile -t COMPREPLY < <(compgen -W "$(_stillpoint_words "${subcommands[@]}")" -- "$word")
}

complete -o default -F _stillpoint stillpoint
