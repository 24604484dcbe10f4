// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/record/output_folder.h"
#include "bench/record/output_guard.h"
#include "core/base/error.h"
#include "reports/page/report_page.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::string store;
  std::string out;
  std::string plan;
};

int write_report(const ReportArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "is required: the output folder of index.html");
  const fs::path out = arguments.out;
  require_safe_folder(out, {.names = {"index.html", "tables"}, .marks = {{"index.html", "tables"}}},
                      {arguments.store});
  require_writable(out);
  const Store store(arguments.store);
  const report::ReportSubject subject = report::report_subject(store, arguments.plan);
  std::vector<OutputFile> tables;
  for (const report::ReportTable& table : report::report_tables(subject)) {
    for (OutputFile& file : report::table_files(table)) tables.push_back(std::move(file));
  }
  const std::string page = report::report_html(store, subject);
  write_files(out / "tables", tables);
  write_files(out, {{"index.html", page}});
  std::cout << fmt::format("{} runs; wrote {} ({:.1f} MB) and {} files in {}\n", subject.runs.size(),
                           (out / "index.html").string(), static_cast<double>(page.size()) / 1e6,
                           tables.size(), (out / "tables").string());
  for (const std::string& gap : subject.gaps) spdlog::warn("{}; the page lacks their content", gap);
  return subject.gaps.empty() ? kExitOk : kExitFindings;
}

}  // namespace

Command report_command() {
  const auto arguments = std::make_shared<ReportArguments>();
  return {.name = "report",
          .summary =
              "Write a self-contained HTML report of a store: tables, ablations, trajectories, time series, "
              "run times",
          .example = "report build/bench/store.sqlite --out build/report",
          .options = {{"STORE", "Store created by `stillpoint bench`", &arguments->store},
                      {"--out", "Output folder of index.html and tables/", &arguments->out},
                      {"--plan", "Only the runs of this plan [all plans]", &arguments->plan}},
          .action = [arguments] { return write_report(*arguments); }};
}

}  // namespace stillpoint::bench
