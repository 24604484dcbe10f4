// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/object_detector.h"

#include "core/base/error.h"
#include "core/detector/network_detector.h"
#include "core/detector/no_detector.h"
#include "core/detector/recorded_detector.h"
#include "core/detector/simulated_detector.h"
#include "core/detector/sparse_detector.h"

namespace stillpoint {
namespace {

std::unique_ptr<ObjectDetector> make_for_every_frame(const DetectorConfig& config,
                                                     const DetectorInput& input) {
  switch (config.kind) {
    case DetectorKind::kNone:
      return std::make_unique<NoDetector>();
    case DetectorKind::kRecorded:
      return std::make_unique<RecordedDetector>(input.boxes, config.max_time_difference_s);
    case DetectorKind::kNetwork:
      return std::make_unique<NetworkDetector>(config, input.dynamic_classes);
    case DetectorKind::kSimulated:
      return std::make_unique<SimulatedDetector>(input.boxes, config, input.seed);
  }
  check_failed("a detector of this kind exists", __FILE__, __LINE__);
}

}  // namespace

std::unique_ptr<ObjectDetector> make_object_detector(const DetectorConfig& config,
                                                     const DetectorInput& input) {
  std::unique_ptr<ObjectDetector> detector = make_for_every_frame(config, input);
  if (config.every_n_frames == 1) return detector;
  return std::make_unique<SparseDetector>(std::move(detector), config.every_n_frames);
}

}  // namespace stillpoint
