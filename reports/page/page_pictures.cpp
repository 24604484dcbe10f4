// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/page_pictures.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "reports/page/series_text.h"

namespace stillpoint {
namespace {

using Json = nlohmann::ordered_json;

std::string picture_text(const Store& store, const StoredRun& run, const std::string& kind) {
  const std::string jpeg = store.attachment(run, kind);
  return base64({reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size()});
}

/// Pictured frames of a run, worst first.
std::vector<std::size_t> pictured(const RunSeries& series) {
  std::vector<std::size_t> frames = series.worst;
  std::erase_if(frames, [&](std::size_t frame) { return !series.pictures.contains(frame); });
  return frames;
}

}  // namespace

std::vector<std::string> page_pictures(const Store& store, std::span<const StoredRun> runs,
                                       std::span<const RunSeries> series, std::size_t room) {
  std::vector<Json> pictures(runs.size(), Json::object());
  std::vector<std::vector<std::size_t>> frames;
  std::size_t ranks = 0;
  for (const RunSeries& one : series) {
    frames.push_back(pictured(one));
    ranks = std::max(ranks, frames.back().size());
  }
  bool is_full = false;
  for (std::size_t rank = 0; rank < ranks && !is_full; ++rank) {
    for (std::size_t run = 0; run < runs.size() && !is_full; ++run) {
      if (rank >= frames[run].size()) continue;
      const std::size_t frame = frames[run][rank];
      std::string text = picture_text(store, runs[run], series[run].pictures.at(frame));
      is_full = text.size() > room;
      if (is_full) continue;
      room -= text.size();
      pictures[run][std::to_string(frame)] = std::move(text);
    }
  }
  std::vector<std::string> texts;
  for (const Json& json : pictures) texts.push_back(json.dump());
  return texts;
}

}  // namespace stillpoint
