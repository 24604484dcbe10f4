// SPDX-License-Identifier: BSD-3-Clause
/// Declarative description of a subcommand. command_line.cpp converts it to CLI11 objects.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace stillpoint::bench {

/// Destination of an option's value; its type determines the accepted values. A bool is a flag without a
/// value, a vector is an option that may be repeated.
using OptionTarget = std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*>;

/// An option (`--out`) or, when its name does not begin with a dash, a required argument (`SEQ`).
struct Option {
  std::string name;
  std::string help;
  OptionTarget target;
  std::string hidden_alias = {};  ///< former name of a vector option; accepted, not listed by --help
};

/// A subcommand. `action` owns the option targets, usually through a captured shared_ptr to a struct.
struct Command {
  std::string name;
  std::string summary;  ///< one line
  std::string example;  ///< a valid command line, without the program name
  std::vector<Option> options;
  std::function<int()> action;  ///< called after parsing if no subcommand was given; returns the exit code.
                                ///< May be empty for commands that require a subcommand
  std::vector<Command> subcommands;
};

}  // namespace stillpoint::bench
