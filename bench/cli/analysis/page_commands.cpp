// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <ctime>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <sstream>
#include <string_view>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "bench/analysis/commit_history.h"
#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/executors/hosts.h"
#include "bench/record/output_folder.h"
#include "bench/serve/static_server.h"
#include "bench/store/store.h"
#include "bench/store/store_progress.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "reports/dashboard/dashboard.h"
#include "reports/dashboard/history_text.h"
#include "reports/live/live_page.h"
#include "reports/page/report_page.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::string store = "build/bench/store.sqlite";
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
  std::cout << fmt::format("{}; wrote {} ({:.1f} MB) and {} in {}\n", counted(subject.runs.size(), "run"),
                           (out / "index.html").string(), static_cast<double>(page.size()) / 1e6,
                           counted(tables.size(), "file"), (out / "tables").string());
  if (const std::string unplanned = report::unplanned_sentence(subject); !unplanned.empty())
    spdlog::info("{}", unplanned);
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
          .options = {store_option(&arguments->store),
                      {"--out", "Output folder of index.html and tables/", &arguments->out},
                      {"--plan", "Only the runs of this plan [all plans]", &arguments->plan}},
          .action = [arguments] { return write_report(*arguments); }};
}

namespace {

/// Where subjects and links of commits come from.
struct CommitArguments {
  std::string repository;
  std::string url;
};

constexpr std::string_view kHashMark = "{commit}";

std::vector<Option> commit_options(CommitArguments& arguments) {
  return {
      {"--repository", "Git repository with the commits: adds their subjects and author dates",
       &arguments.repository},
      {"--commit-url",
       "Page of a commit at a code host, e.g. https://example.org/project/commit/{commit}; {commit} is its "
       "hash",
       &arguments.url}};
}

/// The hash in the name of a commit; empty if it is no hash.
std::string hash_of(const Commit& commit) {
  constexpr std::size_t kMinDigits = 7;
  std::string hash = commit.name.substr(0, commit.name.find('+'));
  const bool is_hash =
      hash.size() >= kMinDigits && hash.find_first_not_of("0123456789abcdef") == std::string::npos;
  return is_hash ? hash : "";
}

/// Adds subjects and author dates of the commits that the repository contains.
/// @throws InputError with the message of git
void add_subjects(std::vector<Commit>& commits, const std::string& repository) {
  constexpr char kFieldEnd = '\x1f';
  ToolCall git{.program = "git",
               .arguments = {"-C", repository, "-c", "log.showSignature=false", "log", "--no-walk=unsorted",
                             "--ignore-missing", "--format=%H%x1f%at%x1f%s"}};
  std::map<std::string, std::vector<Commit*>> by_hash;
  for (Commit& commit : commits) {
    const std::string hash = hash_of(commit);
    if (!hash.empty()) by_hash[hash].push_back(&commit);
  }
  if (by_hash.empty()) return;
  for (const auto& [hash, same] : by_hash) git.arguments.push_back(hash);
  git.arguments.emplace_back("--");
  std::istringstream lines(require_tool(git));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::string hash;
    std::string seconds;
    std::string subject;
    std::getline(fields, hash, kFieldEnd);
    std::getline(fields, seconds, kFieldEnd);
    std::getline(fields, subject);
    const auto next = by_hash.upper_bound(hash);
    if (next == by_hash.begin() || !hash.starts_with(std::prev(next)->first)) continue;
    for (Commit* commit : std::prev(next)->second) {
      commit->subject = subject;
      commit->authored = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time_t{std::stoll(seconds)}));
    }
  }
}

/// @throws InputError if the address of commits is no template
report::DescribeCommits describe_commits(const CommitArguments& arguments) {
  const std::string& url = arguments.url;
  const bool is_web = url.starts_with("https://") || url.starts_with("http://");
  if (!url.empty() && (!is_web || url.find(kHashMark) == std::string::npos))
    throw InputError("--commit-url", "\"" + url +
                                         "\" must begin with https:// or http:// and contain {commit}, e.g. "
                                         "https://example.org/project/commit/{commit}");
  return [arguments](std::vector<Commit>& commits) {
    if (!arguments.repository.empty()) add_subjects(commits, arguments.repository);
    if (arguments.url.empty()) return;
    for (Commit& commit : commits) {
      const std::string hash = hash_of(commit);
      if (hash.empty()) continue;
      commit.link = arguments.url;
      commit.link.replace(commit.link.find(kHashMark), kHashMark.size(), hash);
    }
  };
}

Command with_commit_options(Command command, CommitArguments& arguments) {
  for (Option& option : commit_options(arguments)) command.options.push_back(std::move(option));
  return command;
}

struct DashboardArguments {
  std::string store = "build/bench/store.sqlite";
  std::string out;
  std::string format = "markdown";
  std::string system;
  CommitArguments commits;
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
  const std::vector<OutputFile> files =
      report::dashboard_files(store, arguments.system, describe_commits(arguments.commits));
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
  const auto [history, changes] =
      report::analyze_history(store, arguments.system, describe_commits(arguments.commits));
  log_other_systems(store, history.system);
  std::cout << (arguments.format == "json" ? report::regressions_json(history, changes)
                                           : report::regressions_markdown(history, changes));
  return report::has_findings(history, changes) ? kExitFindings : kExitOk;
}

}  // namespace

Command dashboard_command() {
  const auto arguments = std::make_shared<DashboardArguments>();
  Command command = {
      .name = "dashboard",
      .summary = "Write a static HTML dashboard of all metrics over commits, with detected changes",
      .example = "dashboard build/bench/store.sqlite --out build/dashboard",
      .options = {store_option(&arguments->store),
                  {"--out", "Output folder of index.html, commits/ and the list of regressions",
                   &arguments->out},
                  {"--system", kSystemHelp, &arguments->system}},
      .action = [arguments] { return dashboard(*arguments); }};
  return with_commit_options(std::move(command), arguments->commits);
}

Command regressions_command() {
  const auto arguments = std::make_shared<DashboardArguments>();
  Command command = {
      .name = "regressions",
      .summary = "List open regressions and drifts; exit code 0 = none, 1 = some, 2 = error",
      .example = "regressions build/bench/store.sqlite --format json",
      .options = {store_option(&arguments->store),
                  {"--format", "Output format: markdown or json [markdown]", &arguments->format},
                  {"--system", kSystemHelp, &arguments->system}},
      .action = [arguments] { return regressions(*arguments); }};
  return with_commit_options(std::move(command), arguments->commits);
}

namespace {

struct ServeArguments {
  std::string store = "build/bench/store.sqlite";
  std::string system;
  bool watch = false;
  CommitArguments commits;
  ServerOptions server;
};

std::vector<OutputFile> in_folder(const std::string& folder, std::vector<OutputFile> files) {
  for (OutputFile& file : files) file.name = folder + file.name;
  return files;
}

/// Files of the dashboard below `folder`, and of the report below "report/".
std::vector<OutputFile> served_files(const Store& store, const ServeArguments& arguments,
                                     const std::string& folder) {
  std::vector<OutputFile> files = in_folder(
      folder, report::dashboard_files(store, arguments.system, describe_commits(arguments.commits)));
  for (OutputFile& file :
       in_folder("report/", report::served_report(store, report::report_subject(store, ""))))
    files.push_back(std::move(file));
  return files;
}

/// The pages of a store that changes, and the messages that say how.
class WatchedPages {
 public:
  explicit WatchedPages(const ServeArguments& arguments)
      : arguments_(arguments),
        index_{"index.html",
               report::live_html(fs::path(arguments.store).filename().string(), StaticServer::kEvents)},
        reader_(std::make_unique<ProgressReader>(arguments.store)),
        server_({index_}, arguments.server) {}

  [[nodiscard]] const StaticServer& server() const { return server_; }

  /// Publishes the state of the store, and renders its pages: in at most a tenth of the time while there are
  /// workers.
  void update() {
    if (reader_->is_replaced() && !open_again()) return;
    const bool changed = reader_->has_changed();
    is_outdated_ = is_outdated_ || changed;
    if (!changed && !is_outdated_ && !has_workers_) return;
    const StoreProgress progress = reader_->read(std::chrono::system_clock::now(), kNewestRuns);
    has_workers_ = progress.workers > 0;
    if (is_outdated_ && (!has_workers_ || Clock::now() >= next_rendering_)) render(progress);
    server_.publish(report::progress_json(progress, rendered_));
  }

 private:
  using Clock = std::chrono::steady_clock;

  static constexpr std::size_t kNewestRuns = 50;
  static constexpr int kPauses = 9;  // duration of the pause after a rendering, in renderings

  /// Opens the store that is at the place of a removed one. @return false if there is none yet
  bool open_again() {
    try {
      reader_ = std::make_unique<ProgressReader>(arguments_.store);
      spdlog::info("{} is another store now", arguments_.store);
      is_missing_ = false;
      is_outdated_ = true;
    } catch (const InputError& error) {
      if (!is_missing_) spdlog::warn("{}; the pages show its last content", error.what());
      is_missing_ = true;
    }
    return !is_missing_;
  }

  void render(const StoreProgress& progress) {
    is_outdated_ = false;
    if (progress.ended == 0) return;
    const Clock::time_point start = Clock::now();
    try {
      std::vector<OutputFile> files = served_files(reader_->store(), arguments_, "dashboard/");
      files.push_back(index_);
      server_.replace(files);
      rendered_ = static_cast<std::size_t>(progress.ended);
    } catch (const InputError& error) {
      spdlog::warn("{}; report and dashboard are not up to date", error.what());
    }
    next_rendering_ = Clock::now() + kPauses * (Clock::now() - start);
  }

  ServeArguments arguments_;
  OutputFile index_;
  std::unique_ptr<ProgressReader> reader_;
  StaticServer server_;
  std::size_t rendered_ = 0;  ///< runs of the pages
  bool is_outdated_ = false;  ///< the store was written after the last rendering
  bool has_workers_ = false;
  bool is_missing_ = false;  ///< the store was removed
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
    const StaticServer server(served_files(Store(arguments.store), arguments, ""), arguments.server);
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
          {store_option(&arguments->store),
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
