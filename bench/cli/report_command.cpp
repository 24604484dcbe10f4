// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "reports/page/report_page.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::string store;
  std::string out;
  std::string plan;
};

int report(const ReportArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "is missing; give the folder for index.html");
  const fs::path out = arguments.out;
  require_writable(out);
  const Store store(arguments.store);
  const ReportSubject subject = report_subject(store, arguments.plan);
  std::vector<OutputFile> tables;
  for (const ReportTable& table : report_tables(subject)) {
    for (OutputFile& file : table_files(table)) tables.push_back(std::move(file));
  }
  const std::string page = report_html(store, subject);
  write_files(out / "tables", tables);
  write_files(out, {{"index.html", page}});
  std::cout << fmt::format("{} runs; written {} ({:.1f} MB) and {} files in {}\n", subject.runs.size(),
                           (out / "index.html").string(), static_cast<double>(page.size()) / 1e6,
                           tables.size(), (out / "tables").string());
  return kExitOk;
}

}  // namespace

Command report_command() {
  const auto arguments = std::make_shared<ReportArguments>();
  return {.name = "report",
          .summary = "Write one offline page about a store: tables, ablations, paths, series, times",
          .example = "report build/bench/store.sqlite --out build/report",
          .options = {{"STORE", "Store that `stillpoint bench` filled", &arguments->store},
                      {"--out", "Folder for index.html and tables/", &arguments->out},
                      {"--plan", "Only the runs of this plan [all plans]", &arguments->plan}},
          .action = [arguments] { return report(*arguments); },
          .subcommands = {}};
}

}  // namespace stillpoint
