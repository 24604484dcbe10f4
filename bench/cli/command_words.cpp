// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/command_words.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/config/spelling.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

bool is_option(const std::string& word) { return word.starts_with('-'); }

std::vector<std::string> names_of(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name);
  return names;
}

const Command* find(const std::vector<Command>& commands, const std::string& name) {
  const auto found = std::ranges::find(commands, name, &Command::name);
  return found == commands.end() ? nullptr : &*found;
}

[[noreturn]] void throw_unknown(const std::string& word, const std::string& parent,
                                const std::vector<Command>& commands) {
  const std::vector<std::string> known = names_of(commands);
  const std::string remedy = suggestion(word, known);
  throw InputError(
      "command line",
      fmt::format("unknown command \"{}{}\"{}", parent.empty() ? "" : parent + " ", word,
                  remedy.empty() ? fmt::format("; expected one of: {}", fmt::join(known, ", ")) : remedy));
}

[[noreturn]] void throw_missing(const std::string& parent, const std::vector<Command>& commands) {
  throw InputError(
      "command line",
      fmt::format("{} requires a {}: {}; try --help", parent.empty() ? "stillpoint" : parent,
                  parent.empty() ? "command" : "subcommand", fmt::join(names_of(commands), ", ")));
}

}  // namespace

std::vector<std::string> without_help_word(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

std::vector<std::string> selected_names(std::span<const std::string> words,
                                        const std::vector<Command>& commands) {
  std::vector<std::string> names;
  const std::vector<Command>* level = &commands;
  const Command* command = nullptr;
  bool has_option = false;
  for (const std::string& word : words) {
    has_option = has_option || is_option(word);
    // Options of the program may precede the command; the value of any other option is not a subcommand.
    if (is_option(word) && command == nullptr) continue;
    if (is_option(word) || level->empty()) break;
    const Command* found = find(*level, word);
    if (found == nullptr && command != nullptr && command->action) break;  // an argument
    if (found == nullptr) throw_unknown(word, fmt::format("{}", fmt::join(names, " ")), *level);
    names.push_back(word);
    command = found;
    level = &found->subcommands;
  }
  const bool requires_name = command == nullptr || (!command->action && !level->empty());
  if (requires_name && !has_option) throw_missing(fmt::format("{}", fmt::join(names, " ")), *level);
  return names;
}

const Command* find_command(std::span<const std::string> names, const std::vector<Command>& commands) {
  const std::vector<Command>* level = &commands;
  const Command* command = nullptr;
  for (const std::string& name : names) {
    command = find(*level, name);
    level = &command->subcommands;
  }
  return command;
}

std::string unknown_option(const std::string& typed, const Command* command) {
  const std::string name = typed.substr(0, typed.find('='));
  std::vector<std::string> known = {"--help", "--verbose"};
  if (command == nullptr) known.emplace_back("--version");
  if (command != nullptr) {
    for (const Option& option : command->options) {
      if (is_option(option.name)) known.push_back(option.name);
    }
  }
  const bool is_long = name.starts_with("--");
  return "unknown option \"" + name + "\"" + (is_long ? suggestion(name, known) : "");
}

}  // namespace stillpoint::bench
