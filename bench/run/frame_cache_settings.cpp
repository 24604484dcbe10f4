// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/frame_cache_settings.h"

#include <cstdlib>
#include <fstream>

#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/synthetic/sequence/sequence_cache.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "STILLPOINT_CACHE_SIZE";
constexpr const char* kLimitFile = "limit.txt";

}  // namespace

fs::path frame_cache_folder() { return synth::cache_folder() / "frames"; }

fs::path checksum_folder() {
  try {
    return synth::cache_folder() / "checksums";
  } catch (const InputError&) {  // without a home folder; the checksum is computed in every run
    return {};
  }
}

std::uint64_t frame_cache_limit(const fs::path& folder) {
  const char* const set = std::getenv(kVariable);
  if (set != nullptr && *set != '\0') return datasets::size_from_text(kVariable, set);
  std::ifstream in(folder / kLimitFile);
  std::string text;
  return std::getline(in, text) ? datasets::size_from_text((folder / kLimitFile).string(), text)
                                : datasets::kDefaultFrameCacheBytes;
}

void store_frame_cache_limit(const fs::path& folder, std::uint64_t bytes) {
  std::error_code error;
  fs::create_directories(folder, error);
  std::ofstream out(folder / kLimitFile);
  out << bytes << '\n';
  out.close();
  if (!out)
    throw InputError((folder / kLimitFile).string(), "cannot be written; check the folder's permissions");
}

std::optional<datasets::FrameCacheOptions> frame_cache_options(
    std::size_t max_frames, const std::function<void(const std::string& text)>& warn) {
  fs::path folder;
  try {
    folder = frame_cache_folder();
  } catch (const InputError& error) {
    if (warn) warn(std::string(error.what()) + "; the run continues without the frame cache");
    return std::nullopt;
  }
  const std::uint64_t limit = frame_cache_limit(folder);
  if (limit == 0) return std::nullopt;
  return datasets::FrameCacheOptions{
      .folder = folder, .max_bytes = limit, .max_frames = max_frames, .warn = warn};
}

}  // namespace stillpoint::bench
