// SPDX-License-Identifier: BSD-3-Clause
/// Checks the names of commands and options on a command line before it is parsed, to suggest the nearest
/// one.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/cli/command_line.h"

namespace stillpoint::bench {

/// `help eval openloris` as `eval openloris --help`, `help` as `--help`; other words unchanged.
[[nodiscard]] std::vector<std::string> without_help_word(std::vector<std::string> words);

/// The words that select a command and its subcommand, e.g. {"store", "list"}.
/// @param words the arguments of the program
/// @throws InputError for an unknown or missing command or subcommand; names the nearest one
[[nodiscard]] std::vector<std::string> selected_names(std::span<const std::string> words,
                                                      const std::vector<Command>& commands);

/// The command with these names, as returned by `selected_names`; null without names.
[[nodiscard]] const Command* find_command(std::span<const std::string> names,
                                          const std::vector<Command>& commands);

/// The message for an option that `command` does not have.
/// @param typed as on the command line, e.g. "--sotre=a.sqlite"
/// @param command may be null: the options of the program itself
[[nodiscard]] std::string unknown_option(const std::string& typed, const Command* command);

}  // namespace stillpoint::bench
