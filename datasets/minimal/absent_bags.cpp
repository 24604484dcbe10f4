// SPDX-License-Identifier: BSD-3-Clause
// The readers of bags in the minimal build (STILLPOINT_MINIMAL), which has none: bags are recognized and
// refused.
#include "core/base/error.h"
#include "datasets/bags/bag_geometry.h"
#include "datasets/formats/bag_format.h"
#include "datasets/formats/formats.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

[[noreturn]] void refuse(const std::string& bag) {
  throw InputError(
      bag,
      "is a bag, and this build reads none (STILLPOINT_MINIMAL); write a folder with a full build, "
      "`stillpoint data export`");
}

}  // namespace

const SequenceFormat kBagFormat{
    .name = "bag",
    .signature = "no files: this build reads no bags (STILLPOINT_MINIMAL)",
    .recognize = eval::is_bag,
    .read = [](const std::filesystem::path& path, FaultLog&) -> SequenceContent { refuse(path.string()); }};

SequenceContent read_bag_sequence(const std::filesystem::path& path, std::span<const std::string>,
                                  FaultLog&) {
  refuse(path.string());
}

/// Never reached: there is no content of a bag.
SequenceContent with_metric_accelerations(SequenceContent content) { return content; }

std::optional<BagTopic> parse_bag_topic(const std::string& text) {
  const std::string bag = text.substr(0, text.find(':'));
  if (bag != text && eval::is_bag(bag)) refuse(bag);
  return std::nullopt;
}

eval::LoadedTrajectory read_bag_trajectory(const BagTopic& source) { refuse(source.bag.string()); }

std::vector<eval::StampedCovariance> read_bag_covariances(const BagTopic& source) {
  refuse(source.bag.string());
}

}  // namespace stillpoint::datasets
