// SPDX-License-Identifier: BSD-3-Clause
/// Declarative description of subcommands; parses the command line and executes the selected one.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace stillpoint::bench {

/// Destination of an option's value; its type determines the accepted values. A bool is a flag without a
/// value, a vector is an option that may be repeated.
using OptionTarget = std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*>;

/// Range of the values of a number option. Both ends are allowed. The default admits every number that a
/// command can compute with; nan and inf never are in a range.
struct NumberRange {
  double least = -1e9;
  double most = 1e9;
};

/// An option (`--out`) or, when its name does not begin with a dash, a required argument (`SEQ`).
struct Option {
  std::string name;
  std::string help;
  OptionTarget target;
  NumberRange range = {};         ///< of a number option
  std::string hidden_alias = {};  ///< former name of a vector option; accepted, not listed by --help
  int values = 1;                 ///< > 1: number of values of a vector option, which is then not repeated
  bool may_be_omitted = false;    ///< of an argument
};

/// A subcommand. `action` owns the option targets, usually through a captured shared_ptr to a struct.
struct Command {
  std::string name;
  std::string summary;  ///< one line
  std::string example;  ///< a valid command line, without the program name
  std::vector<Option> options = {};
  std::function<int()> action = {};  ///< called after parsing if no subcommand was given; returns the exit
                                     ///< code. May be empty for commands that require a subcommand
  std::vector<Command> subcommands = {};
};

/// Exit codes of the program.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFindings = 1;       ///< completed, but the result is negative, e.g. a failed run
inline constexpr int kExitBadInput = 2;       ///< invalid usage or input; one error line was printed
inline constexpr int kExitInconclusive = 3;   ///< completed, but the data do not allow a statement
inline constexpr int kExitInternal = 70;      ///< a bug in the program, or out of memory; EX_SOFTWARE
inline constexpr int kExitInterrupted = 130;  ///< 128 + SIGINT, as shells report it

/// @return exit code of the command; `kExitBadInput`, with one line on stderr, for invalid usage or
/// InputError
[[nodiscard]] int run_command_line(int argc, char** argv, const std::vector<Command>& commands);

}  // namespace stillpoint::bench
