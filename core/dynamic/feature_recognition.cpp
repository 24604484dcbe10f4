// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/feature_recognition.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

namespace stillpoint {
namespace {

/// Residual at the predicted pose above which a feature is dynamic, without a covariance: the value of
/// `mcc_threshold_px` in the published code.
constexpr double kGateThreshold_px = 10.0;

/// Largest r_k of the frames that recycle a feature: the accuracy of tracking, far below `mcc_threshold_px`.
constexpr double kRecycleResidual_px = 1.0;

/// Features inside the mask are readmitted while fewer of all are stable. Visual odometry follows people who
/// stand for a while if they are readmitted without a limit: 5.2 instead of 3.3 mm (market, four starts of a
/// prototype). Of the features of the recording two_people_d435, a quarter are on people: with 3/4, those of
/// a leg at rest are readmitted. ATE with a wrong box over the whole image, IMU and VO: 1.4, 3.2 mm with 1/2,
/// 1.3, 3.0 mm with 2/3, 1.2, 3.1 mm with 3/4 (geometric means of 3 sequences, 4 starts).
constexpr double kMinStableRatio = 2.0 / 3.0;

bool is_dynamic(const DynamicLabel& label) { return label.label != LabelClass::kStable; }

/// Whether `enforce_min_stable` may relabel it as stable.
bool can_be_relabeled(const DynamicLabel& label) {
  return is_dynamic(label) && label.reason != LabelReason::kInsideMask;
}

/// Sort key of `enforce_min_stable`, ascending.
auto relabel_order(const DynamicLabel& label) {
  return std::tuple(!can_be_relabeled(label),
                    label.residual_px.value_or(std::numeric_limits<double>::infinity()), label.id);
}

/// Initial label in a new frame, from the label in the previous one.
DynamicLabel propagated_label(const DynamicLabel& before) {
  return {.id = before.id,
          .label = before.label,
          .reason = is_dynamic(before) ? LabelReason::kHistory : LabelReason::kNone};
}

/// Calls `visit(feature, residual)` where both have the same id; both ranges are sorted by id.
template <class Features, class Visit>
void for_each_match(Features& features, std::span<const ConsistencyResidual> residuals, const Visit& visit) {
  auto feature = features.begin();
  for (const ConsistencyResidual& residual : residuals) {
    while (feature != features.end() && feature->label.id < residual.id) ++feature;
    if (feature == features.end()) return;
    if (feature->label.id == residual.id) visit(*feature, residual);
  }
}

/// Labels a feature with a residual above the threshold; features that are already dynamic keep their label.
void label_as_moving(DynamicLabel& label, LabelReason reason) {
  if (is_dynamic(label)) return;
  label.label = LabelClass::kDynamicMotion;
  label.reason = reason;
}

bool fails_gate(const ConsistencyResidual& residual, const DynamicConfig& config) {
  if (config.gate_probability <= 0.0 || !residual.squared_distance)
    return residual.mean_px > kGateThreshold_px;
  // Quantile of the chi-square distribution with two degrees of freedom.
  return *residual.squared_distance > -2.0 * std::log(1.0 - config.gate_probability);
}

}  // namespace

bool FeatureRecognition::is_inside(const TrackedFeature& feature, const DepthView& depth,
                                   const SemanticMask& mask) const {
  const double threshold = mask.threshold_at(feature.pixel);
  if (threshold <= 0.0) return false;
  const double depth_m =
      feature.depth > 0.0 ? feature.depth : median_depth(depth, feature.pixel, config_.depth_window_px);
  if (depth_m > 0.0) return mask.covers(feature.pixel, depth_m);
  return config_.unmeasured_is_dynamic || std::isinf(threshold);
}

const std::vector<DynamicLabel>& FeatureRecognition::classify(const TrackedFrame& frame,
                                                              const SemanticMask& mask) {
  const DepthView depth{.pixels = frame.depth, .units_per_m = frame.depth_units_per_m};
  next_features_.clear();
  auto known = features_.begin();
  for (const TrackedFeature& tracked : frame.features) {
    while (known != features_.end() && known->label.id < tracked.id) ++known;
    const bool is_known = known != features_.end() && known->label.id == tracked.id;
    Feature feature{.label = DynamicLabel{.id = tracked.id}};
    if (is_known)
      feature = {.label = propagated_label(known->label),
                 .static_frames = known->static_frames,
                 .static_residuals = known->static_residuals};
    feature.inside_mask = is_inside(tracked, depth, mask);
    if (feature.inside_mask) {
      feature.static_frames = 0;
      feature.label.label = LabelClass::kDynamicObject;
      feature.label.reason = LabelReason::kInsideMask;
    }
    next_features_.push_back(feature);
  }
  std::swap(features_, next_features_);
  is_predicted_ = false;
  collect_labels();
  return labels_;
}

const std::vector<DynamicLabel>& FeatureRecognition::gate(std::span<const ConsistencyResidual> residuals) {
  for_each_match(features_, residuals, [&](Feature& feature, const ConsistencyResidual& residual) {
    feature.label.residual_px = residual.mean_px;
    if (fails_gate(residual, config_)) label_as_moving(feature.label, LabelReason::kPredictionResidual);
  });
  collect_labels();
  is_predicted_ = std::ranges::any_of(
      residuals, [](const ConsistencyResidual& residual) { return residual.squared_distance.has_value(); });
  if (!is_predicted_) labels_ = enforce_min_stable(std::move(labels_), config_.min_stable_features);
  return labels_;
}

const std::vector<DynamicLabel>& FeatureRecognition::check(std::span<const ConsistencyResidual> residuals,
                                                           std::span<const std::int64_t> readmitted) {
  for (Feature& feature : features_) ++feature.static_frames;
  for_each_match(features_, residuals, [&](Feature& feature, const ConsistencyResidual& residual) {
    feature.label.residual_px = residual.mean_px;
    ++feature.static_residuals;
    if (residual.mean_px > kRecycleResidual_px) feature.static_frames = feature.static_residuals = 0;
    if (residual.mean_px > config_.mcc_threshold_px) {
      label_as_moving(feature.label, LabelReason::kResidual);
    } else if (residual.pair_count + 1 >= config_.mcc_min_observations) {
      recycle(feature);
    }
  });
  if (config_.recycle_min_frames > 0) {
    for (Feature& feature : features_) {
      if (feature.static_frames >= config_.recycle_min_frames) recycle(feature);
    }
  }
  for (Feature& feature : features_) {
    if (std::ranges::binary_search(readmitted, feature.label.id)) recycle(feature, LabelReason::kStatic);
  }
  collect_labels();
  if (!is_predicted_) labels_ = enforce_min_stable(std::move(labels_), config_.min_stable_features);
  return labels_;
}

void FeatureRecognition::recycle(Feature& feature, LabelReason reason) {
  if (!is_dynamic(feature.label) || feature.inside_mask) return;
  feature.label.label = LabelClass::kStable;
  feature.label.reason = reason;
}

void FeatureRecognition::collect_labels() {
  labels_.clear();
  for (const Feature& feature : features_) labels_.push_back(feature.label);
  if (config_.masked_static_frames > 0) readmit_masked();
}

void FeatureRecognition::readmit_masked() {
  const auto stable = std::ranges::count_if(labels_, std::not_fn(is_dynamic));
  auto missing =
      static_cast<std::ptrdiff_t>(std::ceil(kMinStableRatio * static_cast<double>(labels_.size()))) - stable;
  for (std::size_t i = 0; i < features_.size() && missing > 0; ++i) {
    if (!features_[i].inside_mask || features_[i].static_residuals < config_.masked_static_frames) continue;
    labels_[i].label = LabelClass::kStable;
    labels_[i].reason = LabelReason::kRecycled;
    --missing;
  }
}

std::vector<DynamicLabel> enforce_min_stable(std::vector<DynamicLabel> labels, int min_stable) {
  const auto stable = std::ranges::count_if(labels, std::not_fn(is_dynamic));
  for (auto missing = min_stable - stable; missing > 0; --missing) {
    const auto candidate = std::ranges::min_element(labels, {}, relabel_order);
    if (candidate == labels.end() || !can_be_relabeled(*candidate)) break;
    candidate->label = LabelClass::kStable;
    candidate->reason = LabelReason::kMinimumKept;
  }
  return labels;
}

}  // namespace stillpoint
