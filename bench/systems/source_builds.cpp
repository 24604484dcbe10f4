// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/source_builds.h"

#include <algorithm>
#include <ctime>
#include <sstream>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "bench/process/child_process.h"
#include "bench/process/file_lock.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr char kFieldEnd = '\x1f';

/// Folder of the builds of a source: another repository or build command has another one.
fs::path source_folder(const SystemSource& source, const fs::path& repository, const fs::path& builds) {
  std::string identity = repository.string() + kFieldEnd + source.binary;
  for (const std::string& word : source.build) identity += kFieldEnd + word;
  const fs::path parent = builds.empty() ? datasets::cache_folder() / "builds" : fs::absolute(builds);
  return parent / (repository.filename().string() + "-" + hash_text(content_hash(identity)));
}

std::string utc_text(std::time_t seconds) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(seconds));
}

/// The line of an error; git writes advice after some.
std::string git_problem(const std::string& messages) {
  constexpr std::string_view kFatal = "fatal: ";
  const std::size_t begin = messages.find(kFatal);
  if (begin == std::string::npos) return last_line(messages);
  const std::size_t text = begin + kFatal.size();
  return last_line(messages.substr(text, messages.find('\n', text) - text));
}

const SystemSource& required_source(const ExternalSystem& system) {
  if (system.source.binary.empty())
    throw InputError(system.path, "has no table [source]; add git, build and binary");
  return system.source;
}

}  // namespace

SystemSource own_source() {
  return {.git = ".",
          .build = {"sh", "-c", "cmake --preset release && cmake --build build/release --target stillpoint"},
          .binary = "build/release/stillpoint"};
}

SourceBuilds::SourceBuilds(SystemSource source, const fs::path& repository, const fs::path& folder,
                           std::function<bool()> stop_requested)
    : source_(std::move(source)), stop_requested_(std::move(stop_requested)) {
  std::error_code error;
  repository_ = fs::canonical(repository, error);
  if (error || !fs::is_directory(repository_))
    throw InputError(repository.string(), "is no folder; state that of a git repository");
  if (source_.build.empty())
    throw InputError("source.build", "is empty; add the command that builds the program to [source]");
  folder_ = source_folder(source_, repository_, folder);
  fs::create_directories(folder_);
}

SourceBuilds::SourceBuilds(const ExternalSystem& system, const fs::path& folder,
                           std::function<bool()> stop_requested)
    : SourceBuilds(required_source(system), system.source_folder, folder, std::move(stop_requested)) {}

std::string SourceBuilds::git(const std::vector<std::string>& arguments) const {
  const fs::path output = folder_ / fmt::format("git-{}.out", getpid());
  ProcessSpec spec{.program = "git", .arguments = {"-C", repository_.string()}, .output = output};
  spec.arguments.insert(spec.arguments.end(), arguments.begin(), arguments.end());
  const ProcessResult result = run_process(spec);
  std::string text = fs::exists(output) ? eval::read_text_file(output) : "";
  fs::remove(output);
  if (result.exit_code != 0 || result.signal != 0)
    throw InputError(repository_.string(), "git: " + git_problem(result.messages) + shallow_remedy());
  return text;
}

std::string SourceBuilds::shallow_remedy() const {
  std::error_code ignored;
  const bool is_shallow = fs::exists(repository_ / ".git" / "shallow", ignored);
  return is_shallow ? "; the clone is shallow, complete it with `git fetch --unshallow --tags`" : "";
}

/// Of `git log`, in its order.
std::vector<SourceCommit> SourceBuilds::log(const std::vector<std::string>& arguments) const {
  std::vector<std::string> all = {"-c", "log.showSignature=false", "log", "--format=%H%x1f%ct%x1f%s"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::istringstream lines(git(all));
  std::vector<SourceCommit> commits;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    SourceCommit& commit = commits.emplace_back();
    std::string seconds;
    std::getline(fields, commit.hash, kFieldEnd);
    std::getline(fields, seconds, kFieldEnd);
    std::getline(fields, commit.subject);
    commit.time = utc_text(std::stoll(seconds));
  }
  return commits;
}

std::map<std::string, std::string> SourceBuilds::increasing_times(const std::string& newest) const {
  std::istringstream lines(git({"-c", "log.showSignature=false", "log", "--first-parent", "--reverse",
                                "--format=%H %ct", newest, "--"}));
  std::map<std::string, std::string> times;
  std::time_t last = 0;
  std::time_t seconds = 0;
  for (std::string hash; lines >> hash >> seconds; times[hash] = utc_text(last))
    last = times.empty() ? seconds : std::max(seconds, last + 1);
  return times;
}

std::vector<SourceCommit> SourceBuilds::commits(const std::string& range, int most) const {
  const std::string limit = "--max-count=" + std::to_string(most > 0 ? most : -1);
  std::vector<SourceCommit> commits = log({"--first-parent", limit, "--end-of-options", range, "--"});
  if (commits.empty()) throw InputError(range, "contains no commit; write OLD..NEW");
  const std::map<std::string, std::string> times = increasing_times(commits.front().hash);
  for (SourceCommit& commit : commits) {
    const auto found = times.find(commit.hash);  // none of another tip of the range
    if (found != times.end()) commit.time = found->second;
  }
  return commits;
}

SourceCommit SourceBuilds::commit(const std::string& revision) const {
  return log({"--max-count=1", "--end-of-options", revision, "--"}).at(0);
}

std::vector<SourceCommit> SourceBuilds::between(const SourceCommit& good, const SourceCommit& bad) const {
  std::vector<SourceCommit> commits = log({"--first-parent", "--reverse", good.hash + ".." + bad.hash, "--"});
  const bool is_ancestor = git({"rev-list", "--max-count=1", good.hash, "^" + bad.hash}).empty();
  if (!is_ancestor || commits.empty())
    throw InputError(good.short_hash() + ".." + bad.short_hash(),
                     "the first commit is no ancestor of the second one; write GOOD..BAD" + shallow_remedy());
  return commits;
}

void SourceBuilds::add_tree(const SourceCommit& commit, const fs::path& tree) const {
  fs::remove_all(tree);  // of a build that was interrupted
  static_cast<void>(git({"worktree", "prune"}));
  // The second --force is for a work tree that is locked since the process that added it was killed.
  static_cast<void>(git({"worktree", "add", "--force", "--force", "--detach", tree.string(), commit.hash}));
}

bool SourceBuilds::is_busy() const { return is_locked(folder_ / "lock"); }

SourceBuild SourceBuilds::build(const SourceCommit& commit) const {
  const FileLock lock(folder_ / "lock", LockKind::kExclusive, stop_requested_);
  if (stop_requested_ && stop_requested_()) return {.failure = "stopped"};
  const fs::path tree = folder_ / commit.hash;
  const fs::path mark = folder_ / (commit.hash + ".built");
  SourceBuild build{.tree = tree, .program = tree / source_.binary, .failure = {}, .use = nullptr};
  build.cached = fs::exists(mark) && fs::exists(build.program);
  if (!build.cached) {
    fs::remove(mark);
    add_tree(commit, tree);
  }
  fs::last_write_time(tree, fs::file_time_type::clock::now());  // the order of `keep_latest`
  if (build.cached) {
    build.use = std::make_shared<const FileLock>(mark, LockKind::kShared);
    return build;
  }
  ProcessSpec spec{.program = source_.build.front(), .folder = tree, .output_in_messages = true};
  spec.arguments.assign(source_.build.begin() + 1, source_.build.end());
  if (spec.program.string().find('/') != std::string::npos) spec.program = tree / spec.program;
  ProcessPool pool(stop_requested_);
  pool.start(0, spec);
  const ProcessResult result = pool.wait_next()->second;
  const fs::path log = folder_ / (commit.hash + ".log");
  eval::write_text_file(log, result.messages);
  if (result.exit_code != 0 || result.signal != 0) {
    const std::string last = last_line(result.messages);
    const std::string end = result.signal != 0 ? fmt::format("signal {}", result.signal)
                                               : fmt::format("exit status {}", result.exit_code);
    build.failure = fmt::format("the build failed: {}; see {}", last.empty() ? end : last, log.string());
  } else if (!fs::is_regular_file(build.program)) {
    build.failure = "the build wrote no " + source_.binary + "; correct source.binary; see " + log.string();
  } else {
    eval::write_text_file(mark, "");
    build.use = std::make_shared<const FileLock>(mark, LockKind::kShared);
  }
  return build;
}

std::size_t SourceBuilds::keep_latest(std::size_t count) const {
  const FileLock lock(folder_ / "lock", LockKind::kExclusive);
  const auto with_ending = [](fs::path tree, const char* ending) { return tree.concat(ending); };
  std::vector<fs::path> removed, built;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    if (!entry.is_directory()) continue;
    (fs::exists(with_ending(entry.path(), ".built")) ? built : removed).push_back(entry.path());
  }
  std::ranges::sort(built, std::ranges::greater{},
                    [](const fs::path& tree) { return fs::last_write_time(tree); });
  for (std::size_t i = count; i < built.size(); ++i) {
    if (is_locked(with_ending(built[i], ".built"))) continue;
    fs::remove(with_ending(built[i], ".built"));
    fs::remove(with_ending(built[i], ".log"));
    removed.push_back(built[i]);
  }
  for (const fs::path& tree : removed) fs::remove_all(tree);
  if (!removed.empty()) static_cast<void>(git({"worktree", "prune"}));
  return removed.size();
}

ExternalSystem built_system(ExternalSystem system, const SourceCommit& commit, const SourceBuild& build) {
  system.version = commit.hash;
  system.source_folder = build.tree.string();
  system.hash = hash_text(content_hash(system.hash_without_source + commit.hash));
  return system;
}

}  // namespace stillpoint::bench
