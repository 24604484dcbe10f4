// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/landmark_samples.h"

namespace stillpoint::report {
namespace {

constexpr double kSampleInterval_s = 0.495;  // 2 Hz, with jitter
constexpr std::size_t kMaxSamples = 1500;    // 12 kB per run of the page

}  // namespace

void LandmarkSamples::add(const FrameReport& report) {
  const OdometryUpdate& update = report.update;
  if (!is_located(update.status) || update.segment != 0 || report.dynamic.labels.empty()) return;
  if (last_t_ && seconds_between(*last_t_, report.frame.t) < kSampleInterval_s) return;
  last_t_ = report.frame.t;
  auto label = report.dynamic.labels.begin();
  for (const TrackedFeature& feature : report.tracked.features) {  // both by ascending id
    while (label != report.dynamic.labels.end() && label->id < feature.id) ++label;
    if (label == report.dynamic.labels.end()) return;
    if (label->id != feature.id || feature.depth <= 0.0) continue;
    const bool dynamic = label->label != LabelClass::kStable;
    if (taken_.emplace(feature.id, dynamic).second)
      samples_.push_back({update.T_w_c * (feature.depth * feature.bearing.homogeneous()), dynamic});
  }
}

std::string LandmarkSamples::text() const {
  const std::size_t step = (samples_.size() + kMaxSamples - 1) / kMaxSamples;
  std::vector<bench::LandmarkSample> thinned;
  for (std::size_t i = 0; i < samples_.size(); i += step) thinned.push_back(samples_[i]);
  return bench::landmark_text(thinned);
}

}  // namespace stillpoint::report
