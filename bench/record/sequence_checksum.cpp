// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/sequence_checksum.h"

#include <algorithm>
#include <fstream>
#include <vector>

#include "core/base/content_hash.h"
#include "core/base/error.h"

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

}  // namespace stillpoint::bench
