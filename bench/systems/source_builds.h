// SPDX-License-Identifier: BSD-3-Clause
/// Programs built from the commits of a git repository, each in a work tree of its own. Work trees and builds
/// are kept until `keep_latest`, so that a commit is built once.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/process/file_lock.h"
#include "bench/systems/external_system.h"

namespace stillpoint::bench {

struct SourceCommit {
  std::string hash;     ///< 40 digits
  std::string time;     ///< of the commit: UTC, ISO 8601
  std::string subject;  ///< first line of the message

  /// The first digits of the hash, for messages.
  [[nodiscard]] std::string short_hash() const { return hash.substr(0, 10); }
};

/// The build of a commit.
struct SourceBuild {
  std::filesystem::path tree;     ///< work tree
  std::filesystem::path program;  ///< in `tree`
  bool cached = false;            ///< it existed before
  std::string failure;            ///< why there is no program, one line; empty if there is one
  /// Keeps `keep_latest` of all processes from removing it; null if `failure` is not empty.
  std::shared_ptr<const FileLock> use;
};

/// How this odometry is built.
[[nodiscard]] SystemSource own_source();

class SourceBuilds {
 public:
  /// @param repository a folder in it
  /// @param folder receives the builds; empty: builds/ in the cache folder
  /// @param stop_requested polled during a build, which it terminates
  /// @throws InputError if the repository does not exist, or the source has no build command
  SourceBuilds(SystemSource source, const std::filesystem::path& repository,
               const std::filesystem::path& folder, std::function<bool()> stop_requested);

  /// Of a system with the table [source].
  /// @throws InputError if it has none
  SourceBuilds(const ExternalSystem& system, const std::filesystem::path& folder,
               std::function<bool()> stop_requested);

  /// The commits of a range along first parents, the newest first. Their times increase along the history,
  /// whatever the range, so that a dashboard has their order: one that is not later than its parent, as after
  /// a rebase or by a wrong clock, is dated a second after it.
  /// @param range as for `git rev-list`, e.g. "v1.0..HEAD"
  /// @param most only so many, those nearest to the end of the range; 0 = all
  /// @throws InputError with the message of git if there is no such range, or if it is empty
  [[nodiscard]] std::vector<SourceCommit> commits(const std::string& range, int most = 0) const;

  /// @param revision as for `git rev-parse`
  /// @throws InputError with the message of git if it names no commit
  [[nodiscard]] SourceCommit commit(const std::string& revision) const;

  /// The commits after `good` up to `bad`, along first parents, the oldest first; `good` itself is not
  /// included.
  /// @throws InputError with the message of git, or if `good` is no ancestor of `bad`
  [[nodiscard]] std::vector<SourceCommit> between(const SourceCommit& good, const SourceCommit& bad) const;

  /// Whether another process builds a commit of this source now: `build` waits for it.
  [[nodiscard]] bool is_busy() const;

  /// Builds a commit in its work tree unless that was done before; other processes wait meanwhile. What the
  /// build printed last is in HASH.log in the folder of the builds.
  [[nodiscard]] SourceBuild build(const SourceCommit& commit) const;

  /// Removes the builds of this source, with their logs, but for those that `build` was called for last and
  /// those in use; of failed builds, only the logs are kept.
  /// @return number of the removed work trees
  std::size_t keep_latest(std::size_t count) const;

 private:
  [[nodiscard]] std::string git(const std::vector<std::string>& arguments) const;
  [[nodiscard]] std::vector<SourceCommit> log(const std::vector<std::string>& arguments) const;
  /// Times of a commit and all before it, by hash, as `commits` states them.
  [[nodiscard]] std::map<std::string, std::string> increasing_times(const std::string& newest) const;
  /// What to do about commits that are missing; empty if the clone is not shallow.
  [[nodiscard]] std::string shallow_remedy() const;
  void add_tree(const SourceCommit& commit, const std::filesystem::path& tree) const;

  SystemSource source_;
  std::filesystem::path repository_;
  std::filesystem::path folder_;  ///< of this source
  std::function<bool()> stop_requested_;
};

/// The system with the program of a commit: its version is the hash.
/// @param build of which `tree` suffices for the identity of its runs
[[nodiscard]] ExternalSystem built_system(ExternalSystem system, const SourceCommit& commit,
                                          const SourceBuild& build);

}  // namespace stillpoint::bench
