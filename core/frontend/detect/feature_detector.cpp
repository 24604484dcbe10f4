// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/feature_detector.h"

#include "core/base/error.h"
#include "core/frontend/detect/grid_detector.h"
#include "core/frontend/detect/shi_tomasi_detector.h"

namespace stillpoint {

std::unique_ptr<FeatureDetector> make_feature_detector(const FrontendConfig& config) {
  switch (config.detector) {
    case FeatureDetectorKind::kGridFast:
      return std::make_unique<GridDetector>(config.grid, config.max_features);
    case FeatureDetectorKind::kShiTomasi:
      return std::make_unique<ShiTomasiDetector>(config.shi_tomasi_quality);
  }
  check_failed("a detector of this kind exists", __FILE__, __LINE__);
}

}  // namespace stillpoint
