// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/cached_export.h"

#include <sstream>
#include <string>

#include <fmt/format.h>

#include "bench/process/file_lock.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

fs::path list_file(const fs::path& path) { return path.string() + ".files"; }

/// "SIZE TIME NAME" of a file, whose name is relative to the folder of the export.
std::string state_line(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  return fmt::format("{} {} {}", fs::file_size(folder / name, ignored),
                     fs::last_write_time(folder / name, ignored).time_since_epoch().count(), name);
}

std::string list_of(const fs::path& path) {
  const fs::path folder = path.parent_path();
  std::string list;
  const auto add = [&](const fs::path& file) {
    list += state_line(folder, file.lexically_relative(folder).string()) + '\n';
  };
  if (fs::is_regular_file(path)) add(path);
  std::error_code ignored;  // if it is a file
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path, ignored)) {
    if (!entry.is_directory()) add(entry.path());
  }
  return list;
}

}  // namespace

ExportState export_state(const fs::path& path) {
  const fs::path list = list_file(path);
  if (!fs::exists(list)) return ExportState::kNone;
  if (!fs::exists(path)) return ExportState::kChanged;
  std::istringstream lines(eval::read_text_file(list));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t name = line.find(' ', line.find(' ') + 1) + 1;
    if (state_line(path.parent_path(), line.substr(name)) != line) return ExportState::kChanged;
  }
  return ExportState::kIntact;
}

void require_export(const fs::path& path, const std::function<void()>& write) {
  if (export_state(path) == ExportState::kIntact) return;
  fs::create_directories(path.parent_path());
  const FileLock lock(path.parent_path() / "lock", LockKind::kExclusive);
  if (export_state(path) == ExportState::kIntact) return;
  fs::remove_all(path);
  write();
  eval::write_text_file(list_file(path), list_of(path));
}

}  // namespace stillpoint::bench
