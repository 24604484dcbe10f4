// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/command_line.h"

#include <algorithm>
#include <exception>
#include <iostream>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "bench/record/build_info.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

/// Registers `alias` as an unlisted spelling of a vector option. CLI11 processes options in their order of
/// declaration, so the values of the alias follow those of the option.
void add_hidden_alias(CLI::App& app, const std::string& alias, std::vector<std::string>& target) {
  const auto append = [&target](const std::vector<std::string>& values) {
    target.insert(target.end(), values.begin(), values.end());
  };
  app.add_option_function<std::vector<std::string>>(alias, append)->allow_extra_args(false)->group("");
}

/// @param optional whether positional arguments may be omitted, as a subcommand may be given instead
void add_option(CLI::App& app, const Option& option, bool optional) {
  const auto add = [&](auto* target) {
    CLI::Option* added = nullptr;
    if constexpr (std::is_same_v<decltype(target), bool*>) {
      added = app.add_flag(option.name, *target, option.help);
    } else {
      added = app.add_option(option.name, *target, option.help);
    }
    const bool positional = option.name.front() != '-';
    if (positional && !optional) added->required();
    if constexpr (std::is_same_v<decltype(target), std::vector<std::string>*>) {
      if (!positional) added->allow_extra_args(false);
      if (!option.hidden_alias.empty()) add_hidden_alias(app, option.hidden_alias, *target);
    }
  };
  std::visit(add, option.target);
}

void add_command(CLI::App& parent, const Command& command) {
  CLI::App* app = parent.add_subcommand(command.name, command.summary);
  app->footer("Example:\n  stillpoint " + command.example);
  for (const Option& option : command.options) add_option(*app, option, !command.subcommands.empty());
  for (const Command& subcommand : command.subcommands) add_command(*app, subcommand);
  if (!command.subcommands.empty() && !command.action) app->require_subcommand(1);
}

/// The innermost command of a parsed command line.
const Command& selected_command(const CLI::App& app, const std::vector<Command>& commands) {
  const CLI::App* selected = app.get_subcommands().front();
  const auto command = std::find_if(commands.begin(), commands.end(), [&](const Command& candidate) {
    return candidate.name == selected->get_name();
  });
  return selected->get_subcommands().empty() ? *command : selected_command(*selected, command->subcommands);
}

void log_to_stderr(bool verbose) {
  const auto logger = spdlog::stderr_color_mt("stillpoint");
  logger->set_pattern("%n: %^%l%$: %v");
  logger->set_level(verbose ? spdlog::level::debug : spdlog::level::info);
  spdlog::set_default_logger(logger);
}

/// Prints help or version to stdout and returns 0; any other parse result is a usage error.
int finish_parsing(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);
  std::string message = error.what();
  for (char& letter : message) letter = letter == '\n' ? ' ' : letter;
  std::cerr << "stillpoint: error: command line: " << message << "; try --help\n";
  return kExitBadInput;
}

}  // namespace

int run_command_line(int argc, char** argv, const std::vector<Command>& commands) {
  CLI::App app("RGB-D inertial odometry for dynamic scenes, and its benchmark harness", "stillpoint");
  app.require_subcommand(1);
  app.set_version_flag("--version", build_info().version + " (" + build_info().git_commit + ")");
  bool verbose = false;
  app.add_flag("-v,--verbose", verbose, "Log each frame");
  app.parse_complete_callback([&verbose] { log_to_stderr(verbose); });
  for (const Command& command : commands) add_command(app, command);
  try {
    app.parse(argc, argv);
    return selected_command(app, commands).action();
  } catch (const CLI::ParseError& error) {
    return finish_parsing(app, error);
  } catch (const InputError& error) {
    std::cerr << "stillpoint: error: " << error.what() << '\n';
    return kExitBadInput;
  } catch (const std::exception& error) {
    std::cerr << "stillpoint: error: " << error.what() << '\n';
    return kExitInternal;
  }
}

}  // namespace stillpoint::bench
