// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/formats/paired_images.h"

#include <string>
#include <utility>

#include "core/base/error.h"
#include "datasets/io/image_list.h"

namespace stillpoint::datasets {
namespace {

constexpr double kMaxDifference_s = 0.02;  ///< default of the TUM RGB-D benchmark tools

}  // namespace

void add_paired_images(const std::filesystem::path& color_list, const std::filesystem::path& depth_list,
                       SequenceContent& content, FaultLog& faults) {
  const std::vector<StampedFile> color = read_image_list(color_list, faults);
  const std::vector<StampedFile> depth = read_image_list(depth_list, faults);
  const std::vector<std::pair<std::size_t, std::size_t>> pairs = associate(color, depth, kMaxDifference_s);
  if (pairs.empty()) {
    throw InputError(depth_list.string(), "no depth image is within 20 ms of a color image of " +
                                              color_list.filename().string() +
                                              "; are both of the same recording?");
  }
  for (const auto& [in_color, in_depth] : pairs) {
    content.info.frame_times.push_back(color[in_color].t);
    content.frame_files.push_back(
        FrameFiles{.color = color[in_color].file,
                   .depth = depth[in_depth].file,
                   .depth_offset_s = seconds_between(color[in_color].t, depth[in_depth].t)});
  }
  if (const std::size_t unpaired = color.size() - pairs.size(); unpaired > 0) {
    content.info.notes.push_back(std::to_string(unpaired) + " of " + std::to_string(color.size()) +
                                 " color images have no depth image within 20 ms and are dropped");
  }
}

}  // namespace stillpoint::datasets
