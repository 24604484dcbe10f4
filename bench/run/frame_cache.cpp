// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/frame_cache.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "bench/run/frame_prefetcher.h"
#include "bench/run/odometry_run.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "STILLPOINT_CACHE_SIZE";
constexpr const char* kLimitFile = "limit.txt";

}  // namespace

fs::path frame_cache_folder() { return datasets::cache_folder() / "frames"; }

fs::path checksum_folder() {
  try {
    return datasets::cache_folder() / "checksums";
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

void fill_frame_cache(const fs::path& folder, int max_frames, const std::function<bool()>& stop_requested) {
  const auto limit = static_cast<std::size_t>(max_frames);
  const std::optional<datasets::FrameCacheOptions> cache = frame_cache_options(limit, {});
  if (!cache) return;
  const std::unique_ptr<datasets::SensorStream> stream =
      datasets::open_sequence(folder, {.defer_color = true, .frame_cache = cache});
  const std::size_t all = stream->info().frame_times.size();
  const std::size_t frames = limit == 0 ? all : std::min(limit, all);
  FramePrefetcher prefetcher([&](std::size_t index) { return stream->load_frame(index); }, frames,
                             {.threads = kMaxDecodingThreads});
  for (std::size_t i = 0; i < frames && !(stop_requested && stop_requested()); ++i) {
    try {
      static_cast<void>(prefetcher.take(i));
    } catch (const InputError&) {
      continue;  // the run skips the frame, with a warning
    }
  }
}

}  // namespace stillpoint::bench
