// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/formats/paired_pictures.h"

#include <string>
#include <utility>

#include "core/base/error.h"
#include "datasets/picture_list.h"

namespace stillpoint {
namespace {

constexpr double kMaxDifference_s = 0.02;  ///< as the TUM RGB-D benchmark's tools

}  // namespace

void add_paired_pictures(const std::filesystem::path& color_list, const std::filesystem::path& depth_list,
                         SequenceContent& content, FaultLog& faults) {
  const std::vector<StampedFile> color = read_picture_list(color_list, faults);
  const std::vector<StampedFile> depth = read_picture_list(depth_list, faults);
  const std::vector<std::pair<std::size_t, std::size_t>> pairs = associate(color, depth, kMaxDifference_s);
  if (pairs.empty()) {
    throw InputError(depth_list.string(), "no depth picture lies within 20 ms of a colour picture of " +
                                              color_list.filename().string() +
                                              "; are both of one recording?");
  }
  for (const auto& [in_color, in_depth] : pairs) {
    content.info.frame_times.push_back(color[in_color].t);
    content.pictures.push_back(
        PictureFiles{.color = color[in_color].file,
                     .depth = depth[in_depth].file,
                     .depth_offset_s = seconds_between(color[in_color].t, depth[in_depth].t)});
  }
  if (const std::size_t alone = color.size() - pairs.size(); alone > 0) {
    content.info.notes.push_back(std::to_string(alone) + " of " + std::to_string(color.size()) +
                                 " colour pictures have no depth picture within 20 ms and are left out");
  }
}

}  // namespace stillpoint
