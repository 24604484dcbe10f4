// SPDX-License-Identifier: BSD-3-Clause
/// One subcommand as data: what it is called, what it takes, what it does. command_line.cpp makes it real.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace stillpoint {

/// Where the value of an option goes; its type says what is accepted. A bool is a flag without a value, a
/// list an option that may be given several times.
using OptionTarget = std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*>;

/// An option (`--out`) or, when its name does not begin with a dash, a required argument (`SEQ`).
struct Option {
  std::string name;
  std::string help;
  OptionTarget target;
};

/// A subcommand. Targets of its options belong to the state that `action` holds, usually a shared struct.
struct Command {
  std::string name;
  std::string summary;  ///< one line
  std::string example;  ///< a command line that works, without the program's name
  std::vector<Option> options;
  std::function<int()> action;  ///< runs after parsing, unless a subcommand was named; returns the exit code;
                                ///< may be empty then
  std::vector<Command> subcommands;
};

}  // namespace stillpoint
