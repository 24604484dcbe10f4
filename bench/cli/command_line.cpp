// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/command_line.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "bench/cli/console.h"
#include "bench/config/spelling.h"
#include "bench/record/run_environment.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

constexpr const char* kVerboseHelp = "Log each frame";

bool is_option(const std::string& word) { return word.starts_with('-'); }

std::vector<std::string> names_of(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
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

/// `help eval openloris` as `eval openloris --help`, `help` as `--help`; other words unchanged.
std::vector<std::string> without_help_word(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

/// The words that select a command and its subcommand, e.g. {"store", "list"}.
/// @param words the arguments of the program
/// @throws InputError for an unknown or missing command or subcommand; names the nearest one
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
    // An argument, unless it is more like a mistyped subcommand.
    const bool may_be_argument =
        command != nullptr && command->action &&
        (std::filesystem::exists(word) || suggestion(word, names_of(*level)).empty());
    if (found == nullptr && may_be_argument) break;
    if (found == nullptr) throw_unknown(word, fmt::format("{}", fmt::join(names, " ")), *level);
    names.push_back(word);
    command = found;
    level = &found->subcommands;
  }
  const bool requires_name = command == nullptr || (!command->action && !level->empty());
  if (requires_name && !has_option) throw_missing(fmt::format("{}", fmt::join(names, " ")), *level);
  return names;
}

/// The command with these names, as returned by `selected_names`; null without names.
const Command* find_command(std::span<const std::string> names, const std::vector<Command>& commands) {
  const std::vector<Command>* level = &commands;
  const Command* command = nullptr;
  for (const std::string& name : names) {
    command = find(*level, name);
    level = &command->subcommands;
  }
  return command;
}

/// The message for an option that `command` does not have.
/// @param typed as on the command line, e.g. "--sotre=a.sqlite"
/// @param command may be null: the options of the program itself
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

/// Registers `alias` as an unlisted spelling of a vector option. CLI11 processes options in their order of
/// declaration, so the values of the alias follow those of the option.
void add_hidden_alias(CLI::App& app, const std::string& alias, std::vector<std::string>& target) {
  const auto append = [&target](const std::vector<std::string>& values) {
    target.insert(target.end(), values.begin(), values.end());
  };
  app.add_option_function<std::vector<std::string>>(alias, append)->allow_extra_args(false)->group("");
}

/// "must be from 1 to 1000, not nan"; empty if the value is within the range, or is not a number, which the
/// parser reports.
std::string range_problem(const std::string& value, const NumberRange& range) {
  const std::optional<double> number = eval::parse_number(value);
  if (!number || (*number >= range.least && *number <= range.most)) return "";
  return fmt::format("must be from {:g} to {:g}, not {}", range.least, range.most, value);
}

/// @param optional whether positional arguments may be omitted, as a subcommand may be given instead
void add_option(CLI::App& app, const Option& option, bool optional) {
  const auto add = [&](auto* target) {
    CLI::Option* added = nullptr;
    if constexpr (std::is_same_v<decltype(target), bool*>) {
      added = app.add_flag(option.name, *target, option.help);
    } else {
      const std::string argument = option.argument.empty() ? "" : option.argument + ",";
      added = app.add_option(argument + option.name, *target, option.help);
    }
    if constexpr (std::is_same_v<decltype(target), int*> || std::is_same_v<decltype(target), double*>) {
      added->check([range = option.range](const std::string& value) { return range_problem(value, range); });
    }
    const bool positional = option.name.front() != '-';
    if (positional && !optional && !option.may_be_omitted) added->required();
    if constexpr (std::is_same_v<decltype(target), std::vector<std::string>*>) {
      if (!positional) added->allow_extra_args(false);
      if (option.values > 1) added->expected(option.values);  // else it may be repeated
      if (!option.hidden_alias.empty()) add_hidden_alias(app, option.hidden_alias, *target);
    }
  };
  std::visit(add, option.target);
}

/// @param verbose target of the flag -v, which every command accepts
void add_command(CLI::App& parent, const Command& command, bool& verbose) {
  CLI::App* app = parent.add_subcommand(command.name, command.summary);
  app->add_flag("-v,--verbose", verbose, kVerboseHelp);
  app->footer("Example:\n  stillpoint " + command.example);
  for (const Option& option : command.options) add_option(*app, option, !command.subcommands.empty());
  for (const Command& subcommand : command.subcommands) add_command(*app, subcommand, verbose);
  if (!command.subcommands.empty() && !command.action) app->require_subcommand(1);
}

void log_to_stderr(bool verbose) {
  const auto logger = spdlog::stderr_color_mt("stillpoint");
  logger->set_pattern("%n: %^%l%$: %v");
  logger->set_level(verbose ? spdlog::level::debug : spdlog::level::info);
  spdlog::set_default_logger(logger);
}

/// A command line that is checked by name.
struct CommandLine {
  std::vector<std::string> words;
  std::vector<std::string> names;  ///< of the selected command and subcommand
};

/// Prints help or version to stdout.
/// @throws InputError for any other parse result, as it is a usage error
void finish_parsing(const CLI::App& app, const CLI::ParseError& error, const CommandLine& line,
                    const std::vector<Command>& commands) {
  if (error.get_exit_code() == 0) {
    app.exit(error);
    return;
  }
  const std::vector<std::string> remaining = app.remaining(true);
  const auto option = std::ranges::find_if(
      remaining, [](const std::string& word) { return word.size() > 1 && word.starts_with('-'); });
  std::string message = error.what();
  std::ranges::replace(message, '\n', ' ');
  if (option != remaining.end()) message = unknown_option(*option, find_command(line.names, commands));
  throw InputError("command line", message + "; try --help");
}

/// The text with control characters and invalid UTF-8 as `\xNN`, so that all of it is visible; line breaks of
/// messages with several lines remain.
std::string printable(std::string_view text) {
  std::string result;
  for (const char letter : escaped_utf8(text)) {
    const auto code = static_cast<unsigned char>(letter);
    const bool is_control = (code < 0x20 && letter != '\n') || code == 0x7f;
    result += is_control ? fmt::format("\\x{:02x}", code) : std::string(1, letter);
  }
  return result;
}

int print_error(const std::string& message, int exit_code) {
  std::cerr << "stillpoint: error: " << printable(message) << '\n';
  return exit_code;
}

}  // namespace

Option store_option(std::string* store) {
  return {.name = "--store",
          .help = "Database of runs [build/bench/store.sqlite]",
          .target = store,
          .argument = "STORE"};
}

std::function<int()> parse_command_line(int argc, char** argv, const std::vector<Command>& commands) {
  for (int i = 1; i < argc; ++i) require_utf8("argument", argv[i]);
  CommandLine line{.words = without_help_word({argv + 1, argv + argc}), .names = {}};
  line.names = selected_names(line.words, commands);
  CLI::App app("RGB-D inertial odometry for dynamic scenes, and its benchmark harness", "stillpoint");
  app.require_subcommand(1);
  app.set_version_flag("--version", build_info().version + " (" + build_info().git_commit + ")");
  bool verbose = false;
  app.add_flag("-v,--verbose", verbose, kVerboseHelp);
  for (const Command& command : commands) add_command(app, command, verbose);
  try {
    app.parse(std::vector<std::string>(line.words.rbegin(), line.words.rend()));  // CLI11 expects this order
  } catch (const CLI::ParseError& error) {
    finish_parsing(app, error, line, commands);
    return [] { return kExitOk; };
  }
  log_to_stderr(verbose);
  return find_command(line.names, commands)->action;
}

int report_exception() {
  const auto print_exhausted = [](const std::system_error& error) {
    return print_error(std::string("a resource of the system is exhausted: ") + error.what() +
                           "; raise the limit (`ulimit -a`), or end other programs",
                       kExitBadInput);
  };
  try {
    throw;
  } catch (const Interrupted&) {
    std::cerr << "interrupted; run the same command again to continue\n";
    return kExitInterrupted;
  } catch (const InputError& error) {
    return print_error(error.what(), kExitBadInput);
  } catch (const std::filesystem::filesystem_error& error) {
    if (error.code() == std::errc::too_many_files_open ||
        error.code() == std::errc::too_many_files_open_in_system)
      return print_exhausted(error);
    return print_error(error.path1().string() + ": " + error.code().message(), kExitBadInput);
  } catch (const std::system_error& error) {  // of the operating system: too many open files, no more threads
    return print_exhausted(error);
  } catch (const std::bad_alloc&) {
    return print_error("out of memory (bad_alloc)", kExitInternal);
  } catch (const std::exception& error) {
    return print_error(std::string("internal error: ") + error.what() + "; please report it", kExitInternal);
  }
}

}  // namespace stillpoint::bench
