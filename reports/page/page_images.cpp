// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/page_images.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "reports/page/series_text.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

std::string image_base64(const bench::Store& store, const bench::StoredRun& run, const std::string& kind) {
  const std::string jpeg = store.attachment(run, kind);
  return base64({reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size()});
}

/// Frames of a run that have an image, worst first.
std::vector<std::size_t> frames_with_image(const RunSeries& series) {
  std::vector<std::size_t> frames = series.worst;
  std::erase_if(frames, [&](std::size_t frame) { return !series.images.contains(frame); });
  return frames;
}

}  // namespace

std::vector<std::string> page_images(const bench::Store& store, std::span<const bench::StoredRun> runs,
                                     std::span<const RunSeries> series, std::size_t budget_bytes) {
  std::vector<Json> images(runs.size(), Json::object());
  std::vector<std::vector<std::size_t>> frames;
  std::size_t ranks = 0;
  for (const RunSeries& one : series) {
    frames.push_back(frames_with_image(one));
    ranks = std::max(ranks, frames.back().size());
  }
  bool is_full = false;
  for (std::size_t rank = 0; rank < ranks && !is_full; ++rank) {
    for (std::size_t run = 0; run < runs.size() && !is_full; ++run) {
      if (rank >= frames[run].size()) continue;
      const std::size_t frame = frames[run][rank];
      std::string text = image_base64(store, runs[run], series[run].images.at(frame));
      is_full = text.size() > budget_bytes;
      if (is_full) continue;
      budget_bytes -= text.size();
      images[run][std::to_string(frame)] = std::move(text);
    }
  }
  std::vector<std::string> texts;
  for (const Json& json : images) texts.push_back(json.dump());
  return texts;
}

}  // namespace stillpoint::report
