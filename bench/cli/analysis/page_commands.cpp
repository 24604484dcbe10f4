// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <iostream>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "bench/analysis/commit_history.h"
#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/record/output_folder.h"
#include "bench/serve/static_server.h"
#include "bench/store/store.h"
#include "bench/store/store_progress.h"
#include "core/base/error.h"
#include "reports/dashboard/dashboard.h"
#include "reports/dashboard/history_text.h"
#include "reports/live/live_page.h"
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

namespace {

struct DashboardArguments {
  std::string store;
  std::string out;
  std::string format = "markdown";
  std::string system;
};

/// Help of the option --system.
constexpr const char* kSystemHelp =
    "System of the runs, over its versions [stillpoint; the only one in a store without it]";

/// Names the systems that are not shown.
void log_other_systems(const Store& store, const std::string& shown) {
  std::vector<std::string> others = systems_of(store);
  std::erase(others, shown);
  if (!others.empty())
    spdlog::info("shown: {}; the store also has runs of {}: --system NAME", shown, fmt::join(others, ", "));
}

int dashboard(const DashboardArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "is required: the output folder of index.html");
  const fs::path out = arguments.out;
  require_safe_folder(out,
                      {.names = {"index.html", "regressions.md", "regressions.json", "badge.svg", "commits"},
                       .marks = {{"index.html", "regressions.md"}}},
                      {arguments.store});
  require_writable(out);
  const Store store(arguments.store);
  const std::vector<OutputFile> files = report::dashboard_files(store, arguments.system);
  log_other_systems(store, commit_history(store, arguments.system).system);
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
  const Store store(arguments.store);
  const auto [history, changes] = report::analyze_history(store, arguments.system);
  log_other_systems(store, history.system);
  std::cout << (arguments.format == "json" ? report::regressions_json(history, changes)
                                           : report::regressions_markdown(history, changes));
  return report::has_findings(history, changes) ? kExitFindings : kExitOk;
}

}  // namespace

Command dashboard_command() {
  const auto arguments = std::make_shared<DashboardArguments>();
  return {.name = "dashboard",
          .summary = "Write a static HTML dashboard of all metrics over commits, with detected changes",
          .example = "dashboard build/bench/store.sqlite --out build/dashboard",
          .options = {{"STORE", "Store with the runs of several commits", &arguments->store},
                      {"--out", "Output folder of index.html, commits/ and the list of regressions",
                       &arguments->out},
                      {"--system", kSystemHelp, &arguments->system}},
          .action = [arguments] { return dashboard(*arguments); }};
}

Command regressions_command() {
  const auto arguments = std::make_shared<DashboardArguments>();
  return {.name = "regressions",
          .summary = "List open regressions and drifts; exit code 0 = none, 1 = some, 2 = error",
          .example = "regressions build/bench/store.sqlite --format json",
          .options = {{"STORE", "Store with the runs of several commits", &arguments->store},
                      {"--format", "Output format: markdown or json [markdown]", &arguments->format},
                      {"--system", kSystemHelp, &arguments->system}},
          .action = [arguments] { return regressions(*arguments); }};
}

namespace {

struct ServeArguments {
  std::string store;
  std::string system;
  bool watch = false;
  ServerOptions server;
};

std::vector<OutputFile> in_folder(const std::string& folder, std::vector<OutputFile> files) {
  for (OutputFile& file : files) file.name = folder + file.name;
  return files;
}

/// Files of the dashboard below `folder`, and of the report below "report/".
std::vector<OutputFile> served_files(const Store& store, const std::string& system,
                                     const std::string& folder) {
  std::vector<OutputFile> files = in_folder(folder, report::dashboard_files(store, system));
  for (OutputFile& file :
       in_folder("report/", report::served_report(store, report::report_subject(store, ""))))
    files.push_back(std::move(file));
  return files;
}

/// The pages of a store that changes, and the messages that say how.
class WatchedPages {
 public:
  explicit WatchedPages(const ServeArguments& arguments)
      : system_(arguments.system),
        index_{"index.html",
               report::live_html(fs::path(arguments.store).filename().string(), StaticServer::kEvents)},
        reader_(arguments.store),
        server_({index_}, arguments.server) {}

  [[nodiscard]] const StaticServer& server() const { return server_; }

  /// Publishes the state of the store, and renders its pages: in at most a tenth of the time while there are
  /// workers.
  void update() {
    const bool changed = reader_.has_changed();
    is_outdated_ = is_outdated_ || changed;
    if (!changed && !is_outdated_ && !has_workers_) return;
    const StoreProgress progress = reader_.read(std::chrono::system_clock::now(), kNewestRuns);
    has_workers_ = progress.workers > 0;
    if (is_outdated_ && (!has_workers_ || Clock::now() >= next_rendering_)) render(progress);
    server_.publish(report::progress_json(progress, rendered_));
  }

 private:
  using Clock = std::chrono::steady_clock;

  static constexpr std::size_t kNewestRuns = 50;
  static constexpr int kPauses = 9;  // duration of the pause after a rendering, in renderings

  void render(const StoreProgress& progress) {
    is_outdated_ = false;
    if (progress.ended == 0) return;
    const Clock::time_point start = Clock::now();
    try {
      std::vector<OutputFile> files = served_files(reader_.store(), system_, "dashboard/");
      files.push_back(index_);
      server_.replace(files);
      rendered_ = static_cast<std::size_t>(progress.ended);
    } catch (const InputError& error) {
      spdlog::warn("{}; report and dashboard are not up to date", error.what());
    }
    next_rendering_ = Clock::now() + kPauses * (Clock::now() - start);
  }

  std::string system_;
  OutputFile index_;
  ProgressReader reader_;
  StaticServer server_;
  std::size_t rendered_ = 0;  ///< runs of the pages
  bool is_outdated_ = false;  ///< the store was written after the last rendering
  bool has_workers_ = false;
  Clock::time_point next_rendering_{};
};

void log_address(const StaticServer& server, const ServeArguments& arguments, const std::string& content) {
  spdlog::info("serving http://{}:{}/ ({}); press Ctrl-C to stop", arguments.server.address, server.port(),
               content);
  if (!arguments.server.address.starts_with("127."))
    spdlog::warn("{} is not a loopback address: the pages are accessible from other machines",
                 arguments.server.address);
}

int serve(const ServeArguments& arguments) {
  constexpr std::chrono::milliseconds kInterval{500};
  block_interrupts();
  if (!arguments.watch) {
    const StaticServer server(served_files(Store(arguments.store), arguments.system, ""), arguments.server);
    log_address(server, arguments, "current content of the store; the report is at /report/");
    wait_for_interrupt();
    return kExitOk;
  }
  WatchedPages pages(arguments);
  log_address(pages.server(), arguments, "runs as they end");
  do pages.update();
  while (!interrupted_within(kInterval));
  return kExitOk;
}

}  // namespace

Command serve_command() {
  const auto arguments = std::make_shared<ServeArguments>();
  return {
      .name = "serve",
      .summary = "Serve dashboard and report of a store over HTTP, with --watch while a bench writes it",
      .example = "serve build/bench/store.sqlite --watch --port 8035",
      .options =
          {{"STORE", "Store with the runs of several commits", &arguments->store},
           {"--system", kSystemHelp, &arguments->system},
           {"--watch",
            "First page: runs as they end, with progress, rate and remaining time; dashboard/ and report/ "
            "are rendered again",
            &arguments->watch},
           {"--port", "Port to listen on; 0 = any free port [8035]", &arguments->server.port, {0, 65535}},
           {"--address",
            "IPv4 address to listen on; addresses other than loopback give other machines access "
            "[127.0.0.1]",
            &arguments->server.address}},
      .action = [arguments] { return serve(*arguments); }};
}

}  // namespace stillpoint::bench
