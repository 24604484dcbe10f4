// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/record/output_folder.h"
#include "bench/record/output_guard.h"
#include "bench/store/store.h"
#include "core/base/error.h"
#include "reports/dashboard/dashboard.h"
#include "reports/dashboard/regression_list.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

struct DashboardArguments {
  std::string store;
  std::string out;
  std::string format = "markdown";
};

int dashboard(const DashboardArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "is required: the output folder of index.html");
  const fs::path out = arguments.out;
  require_safe_folder(out,
                      {.names = {"index.html", "regressions.md", "regressions.json", "commits"},
                       .marks = {{"index.html", "regressions.md"}}},
                      {arguments.store});
  require_writable(out);
  const std::vector<OutputFile> files = report::dashboard_files(Store(arguments.store));
  std::map<fs::path, std::vector<OutputFile>> by_folder;
  for (const OutputFile& file : files) {
    const fs::path path = out / file.name;
    by_folder[path.parent_path()].push_back({path.filename().string(), file.text});
  }
  for (const auto& [folder, contents] : by_folder) write_files(folder, contents);
  std::cout << fmt::format("wrote {} and {} other files\n", (out / "index.html").string(), files.size() - 1);
  return kExitOk;
}

int regressions(const DashboardArguments& arguments) {
  if (arguments.format != "markdown" && arguments.format != "json")
    throw InputError("--format",
                     "unknown format \"" + arguments.format + "\"; expected one of: markdown, json");
  const auto [history, changes] = report::analyze_history(Store(arguments.store));
  std::cout << (arguments.format == "json" ? report::regressions_json(history, changes)
                                           : report::regressions_markdown(history, changes));
  return report::grouped_shifts(history, changes, ChangeState::kOpen).empty() ? kExitOk : kExitFindings;
}

}  // namespace

Command dashboard_command() {
  const auto arguments = std::make_shared<DashboardArguments>();
  return {.name = "dashboard",
          .summary = "Write a static HTML dashboard of all metrics over commits, with detected changes",
          .example = "dashboard build/bench/store.sqlite --out build/dashboard",
          .options = {{"STORE", "Store with the runs of several commits", &arguments->store},
                      {"--out", "Output folder of index.html, commits/ and the list of regressions",
                       &arguments->out}},
          .action = [arguments] { return dashboard(*arguments); }};
}

Command regressions_command() {
  const auto arguments = std::make_shared<DashboardArguments>();
  return {.name = "regressions",
          .summary = "List open regressions; exit code 0 = none, 1 = some, 2 = error",
          .example = "regressions build/bench/store.sqlite --format json",
          .options = {{"STORE", "Store with the runs of several commits", &arguments->store},
                      {"--format", "Output format: markdown or json [markdown]", &arguments->format}},
          .action = [arguments] { return regressions(*arguments); }};
}

}  // namespace stillpoint::bench
