// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/file_states.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace stillpoint::bench {

namespace fs = std::filesystem;

void add_files(FileStates& states, const fs::path& folder, int depth, const fs::path& excluded) {
  std::error_code error;
  if (fs::is_regular_file(folder, error)) {
    states[folder] = {fs::file_size(folder, error), fs::last_write_time(folder, error)};
    return;
  }
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->path() == excluded || entry->path().filename() == "__pycache__") continue;
    if (entry->is_directory(ignored) && !entry->is_symlink(ignored)) {
      if (depth > 0) add_files(states, entry->path(), depth - 1, excluded);
    } else if (entry->is_regular_file(ignored)) {
      states[entry->path()] = {entry->file_size(ignored), entry->last_write_time(ignored)};
    }
  }
}

std::vector<fs::path> written_files(const FileStates& before, const FileStates& after) {
  std::vector<fs::path> changed;
  for (const auto& [path, state] : after) {
    const auto known = before.find(path);
    if (known == before.end() || known->second != state) changed.push_back(path);
  }
  return changed;
}

std::vector<fs::path> changed_files(const FileStates& before, const FileStates& after) {
  std::vector<fs::path> changed = written_files(before, after);
  for (const auto& [path, state] : before) {
    if (!after.contains(path)) changed.push_back(path);
  }
  return changed;
}

std::string SequenceWatch::changes_of(const fs::path& sequence) {
  constexpr int kDepth = 8;  // deeper than the layout of any dataset
  constexpr std::size_t kShownFiles = 3;
  FileStates now;
  add_files(now, sequence, kDepth, {});
  std::erase_if(now, [](const auto& file) { return file.first.filename().native().starts_with('.'); });
  const FileStates& first = first_.try_emplace(sequence, now).first->second;
  const std::vector<fs::path> files = changed_files(first, now);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < std::min(files.size(), kShownFiles); ++i) {
    const char* const change = !now.contains(files[i])     ? "removed"
                               : !first.contains(files[i]) ? "new"
                                                           : "changed";
    texts.push_back(
        fmt::format("{} {}", files[i].lexically_relative(sequence.parent_path()).string(), change));
  }
  const std::size_t more = files.size() - texts.size();
  return fmt::format("{}{}", fmt::join(texts, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace stillpoint::bench
