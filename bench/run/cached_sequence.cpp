// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/cached_sequence.h"

#include <algorithm>

#include "bench/run/frame_cache_settings.h"
#include "bench/run/frame_prefetcher.h"
#include "bench/run/odometry_run.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {

void fill_frame_cache(const std::filesystem::path& folder, int max_frames,
                      const std::function<bool()>& stop_requested) {
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
