// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/assembly.h"

#include "core/base/error.h"

namespace stillpoint {

std::unique_ptr<ObjectDetector> make_detector(const SensorInput& input, const OdometryConfig& config) {
  DetectorConfig detector = config.detector;
  detector.kind = used_detector(config);
  const bool simulated = detector.kind == DetectorKind::kSimulated;
  if (simulated && input.true_boxes.empty()) {
    throw InputError(
        "detector.kind",
        "\"simulated\" requires true boxes, which only rendered sequences have (true_boxes.txt); use "
        "\"recorded\", \"network\" or \"none\"");
  }
  return make_object_detector(detector, {.boxes = simulated ? input.true_boxes : input.detections,
                                         .dynamic_classes = config.dynamic.classes,
                                         .seed = config.seed,
                                         .change = input.change_detections});
}

Stages assemble(const SensorInput& input, const OdometryConfig& config) {
  return {.rate = WindowRate(config.backend.rate_hz),
          .tracking = TrackingStage(config, input.rig),
          .detector = make_detector(input, config),
          .optimization = OptimizationStage(config, input.rig)};
}

}  // namespace stillpoint
