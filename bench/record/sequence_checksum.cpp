// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/sequence_checksum.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <system_error>
#include <vector>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/io/file_descriptor.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlockBytes = 1 << 20;

std::uint64_t hash_file(const fs::path& file, std::uint64_t hash) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), "cannot be read; check its permissions");
  std::string block(kBlockBytes, '\0');
  while (stream.read(block.data(), kBlockBytes) || stream.gcount() > 0) {
    hash = content_hash(std::string_view(block).substr(0, static_cast<std::size_t>(stream.gcount())), hash);
  }
  return hash;
}

}  // namespace

std::string sequence_checksum(const fs::path& folder) {
  if (fs::is_regular_file(folder)) return hash_text(hash_file(folder, 0));
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::uint64_t hash = 0;
  for (const fs::path& file : files) {
    hash = content_hash(file.lexically_relative(folder).string(), hash);
    hash = hash_file(file, hash);
  }
  return hash_text(hash);
}

namespace {

/// A file that was modified more recently could be modified again without a change of its time.
constexpr std::int64_t kTimeResolution_ns = 100'000'000;

struct FolderState {
  std::string hash;              ///< of names, sizes, times and inodes
  std::int64_t modified_ns = 0;  ///< of the newest file
};

FolderState state_of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder)) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
      files.push_back(entry.path());
  } else {
    files.push_back(folder);
  }
  std::vector<std::string> rows;
  FolderState folder_state;
  for (const fs::path& file : files) {
    const std::optional<datasets::FileState> state = datasets::file_state(file);
    if (!state) continue;
    rows.push_back(file.lexically_relative(folder).string() + '\0' + std::to_string(state->size) + ' ' +
                   std::to_string(state->modified_ns) + ' ' + std::to_string(state->inode) + '\n');
    folder_state.modified_ns = std::max(folder_state.modified_ns, state->modified_ns);
  }
  std::ranges::sort(rows);
  std::uint64_t hash = 0;
  for (const std::string& row : rows) hash = content_hash(row, hash);
  folder_state.hash = hash_text(hash);
  return folder_state;
}

std::int64_t now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

/// Writes the row "STATE CHECKSUM HASH"; its loss costs time only.
void remember(const fs::path& file, const std::string& row) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  const fs::path unfinished = file.string() + "." + std::to_string(::getpid());
  std::ofstream out(unfinished);
  out << row;
  out.close();
  if (out) fs::rename(unfinished, file, error);
  if (!out || error) fs::remove(unfinished, error);
}

}  // namespace

std::string remembered_checksum(const fs::path& folder, const fs::path& cache) {
  const FolderState before = state_of_folder(folder);
  const fs::path file = cache / (hash_text(content_hash(fs::canonical(folder).string())) + ".txt");
  std::ifstream in(file);
  std::string state;
  std::string remembered;
  std::string row_hash;
  const bool read = static_cast<bool>(in >> state >> remembered >> row_hash);
  if (read && state == before.hash && row_hash == hash_text(content_hash(state + remembered)))
    return remembered;
  std::string checksum = sequence_checksum(folder);
  const bool settled = before.modified_ns < now_ns() - kTimeResolution_ns;
  if (cache.empty() || !settled || state_of_folder(folder).hash != before.hash) return checksum;
  remember(file, before.hash + " " + checksum + " " + hash_text(content_hash(before.hash + checksum)));
  return checksum;
}

}  // namespace stillpoint::bench
