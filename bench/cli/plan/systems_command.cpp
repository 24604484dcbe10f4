// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/config/toml_source.h"
#include "bench/record/output_folder.h"
#include "bench/systems/system_check.h"
#include "core/base/error.h"
#include "reports/tables/data_table.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

int list_systems(const std::vector<std::string>& files, bool json) {
  std::vector<std::string> names = embedded_names(TomlKind::kSystem);
  names.insert(names.end(), files.begin(), files.end());
  report::DataTable table{
      .kind = "systems_list", .columns = {"name", "version", "command", "program"}, .rows = {}, .notes = {}};
  for (const std::string& name : names) {
    const ExternalSystem system = load_external_system(name);
    const std::string program = find_program(system);
    table.rows.push_back({name, system.version, system.command.front(), report::data_value(program)});
    if (json) continue;
    std::cout << fmt::format("{:<28} {:<12} {}\n", name, system.version,
                             program.empty() ? "not found: " + system.command.front() : program);
  }
  if (json) std::cout << report::data_json(table);
  return kExitOk;
}

struct SystemCheckArguments {
  std::string system;
  std::string out;
  double time_limit_s = CheckOptions{}.time_limit_s;
  int memory_limit_mb = CheckOptions{}.memory_limit_mb;
};

int check_system(const SystemCheckArguments& arguments) {
  const ExternalSystem system = load_external_system(arguments.system);
  const fs::path folder = arguments.out.empty() ? fs::path("build/bench/systems") / folder_name(system.name)
                                                : fs::path(arguments.out);
  require_safe_folder(folder, {.names = {"out", "program.log"}, .marks = {{"program.log"}}}, {system.folder});
  const SystemCheck result = check_system(system, {.folder = folder,
                                                   .time_limit_s = arguments.time_limit_s,
                                                   .memory_limit_mb = arguments.memory_limit_mb});
  const bool is_ok = result.finding.empty();
  std::cout << system.name << ": " << (is_ok ? "ok: " + result.summary : result.finding) << '\n';
  if (fs::exists(folder / "program.log"))
    std::cout << "messages of the program: " << (folder / "program.log").string() << '\n';
  return is_ok ? kExitOk : kExitFindings;
}

int create(const std::string& name, const std::string& out) {
  const std::string stem = name.ends_with(".toml") ? name.substr(0, name.size() - 5) : name;
  const fs::path file = out.empty() ? fs::path(stem + ".toml") : fs::path(out);
  const std::string text = description_template(fs::path(stem).filename().string());
  static_cast<void>(parse_external_system(text, file.string()));  // the name may be one that none can have
  write_output(file, text, {.inputs = {}});
  std::cout << fmt::format("wrote {}; edit it, then: stillpoint systems check {}\n", file.string(),
                           file.string());
  return kExitOk;
}

Command check_system_command() {
  const auto arguments = std::make_shared<SystemCheckArguments>();
  return {.name = "check",
          .summary = "Run a system for 3 s; name in one line what is wrong with it, and the remedy",
          .example = "systems check my_slam.toml",
          .options = {{"SYSTEM", "Name of a shipped description, or a TOML file", &arguments->system},
                      {"--out",
                       "Folder for the output and the messages of the program "
                       "[build/bench/systems/NAME]",
                       &arguments->out},
                      {"--time-limit",
                       "Seconds after which it is terminated [60]",
                       &arguments->time_limit_s,
                       {0.1, 86400.0}},
                      {"--memory-limit",
                       "Limit in megabytes for it and its children [4096]",
                       &arguments->memory_limit_mb,
                       {1, 10000000}}},
          .action = [arguments] { return check_system(*arguments); }};
}

}  // namespace

Command systems_command() {
  const auto files = std::make_shared<std::vector<std::string>>();
  const auto name = std::make_shared<std::string>();
  const auto out = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  return {.name = "systems",
          .summary = "Describe other SLAM systems, and try them",
          .example = "systems check my_slam.toml",
          .subcommands = {{.name = "list",
                           .summary = "List the shipped descriptions, and where their programs are",
                           .example = "systems list",
                           .options = {{"--file", "A description of your own; may be repeated", files.get()},
                                       {"--json", report::kJsonHelp, json.get()}},
                           .action = [files, json] { return list_systems(*files, *json); }},
                          check_system_command(),
                          system_run_command(),
                          {.name = "new",
                           .summary = "Write a commented description of a system",
                           .example = "systems new my_slam",
                           .options = {{"NAME", "Name of the system in tables", name.get()},
                                       {"--out", "File of the description [NAME.toml]", out.get()}},
                           .action = [name, out] { return create(*name, *out); }}}};
}

}  // namespace stillpoint::bench
