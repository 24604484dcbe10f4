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

bool is_dynamic(const FeatureVerdict& verdict) { return verdict.verdict != Verdict::kStable; }

/// Whether the floor may make it stable.
bool may_be_lifted(const FeatureVerdict& verdict) {
  return is_dynamic(verdict) && verdict.reason != VerdictReason::kInsideMask;
}

/// The floor begins with the smallest.
auto rank_of(const FeatureVerdict& verdict) {
  return std::tuple(!may_be_lifted(verdict),
                    verdict.residual_px.value_or(std::numeric_limits<double>::infinity()), verdict.id);
}

/// The verdict at the beginning of a new picture, before anything in it was looked at.
FeatureVerdict carried_over(const FeatureVerdict& before) {
  return {.id = before.id,
          .verdict = before.verdict,
          .reason = is_dynamic(before) ? VerdictReason::kHistory : VerdictReason::kNothingSuspect};
}

/// Calls `visit(feature, residual)` where both have the same id; both ranges are by rising id.
template <class Features, class Visit>
void for_each_match(Features& features, std::span<const ConsistencyResidual> residuals, const Visit& visit) {
  auto feature = features.begin();
  for (const ConsistencyResidual& residual : residuals) {
    while (feature != features.end() && feature->verdict.id < residual.id) ++feature;
    if (feature == features.end()) return;
    if (feature->verdict.id == residual.id) visit(*feature, residual);
  }
}

/// A residual over the threshold: motion, unless an object was named already.
void flag(FeatureVerdict& verdict, VerdictReason reason) {
  if (is_dynamic(verdict)) return;
  verdict.verdict = Verdict::kDynamicMotion;
  verdict.reason = reason;
}

}  // namespace

bool FeatureRecognition::is_inside(const TrackedFeature& feature, const DepthView& depth,
                                   const SemanticMask& mask) const {
  const double threshold = mask.threshold_at(feature.pixel);
  if (threshold <= 0.0) return false;
  const double meters =
      feature.depth > 0.0 ? feature.depth : robust_depth(depth, feature.pixel, config_.depth_window_px);
  if (meters > 0.0) return mask.covers(feature.pixel, meters);
  return config_.unmeasured_is_dynamic || std::isinf(threshold);
}

const std::vector<FeatureVerdict>& FeatureRecognition::judge(const TrackedFrame& frame,
                                                             const SemanticMask& mask) {
  const DepthView depth{.pixels = frame.depth, .units_per_m = frame.depth_units_per_m};
  present_.clear();
  auto known = features_.begin();
  for (const TrackedFeature& tracked : frame.features) {
    while (known != features_.end() && known->verdict.id < tracked.id) ++known;
    const bool is_known = known != features_.end() && known->verdict.id == tracked.id;
    Feature feature{.verdict = FeatureVerdict{.id = tracked.id}};
    if (is_known) feature = {.verdict = carried_over(known->verdict), .quiet = known->quiet};
    feature.inside_mask = is_inside(tracked, depth, mask);
    if (feature.inside_mask) {
      feature.quiet = 0;
      feature.verdict.verdict = Verdict::kDynamicObject;
      feature.verdict.reason = VerdictReason::kInsideMask;
    }
    present_.push_back(feature);
  }
  std::swap(features_, present_);
  list_verdicts();
  return verdicts_;
}

const std::vector<FeatureVerdict>& FeatureRecognition::gate(std::span<const ConsistencyResidual> residuals) {
  for_each_match(features_, residuals, [&](Feature& feature, const ConsistencyResidual& residual) {
    feature.verdict.residual_px = residual.mean_px;
    if (residual.mean_px > config_.gate_threshold_px)
      flag(feature.verdict, VerdictReason::kPredictionResidual);
  });
  list_verdicts();
  verdicts_ = apply_floor(std::move(verdicts_), config_.min_stable_features);
  return verdicts_;
}

const std::vector<FeatureVerdict>& FeatureRecognition::check(std::span<const ConsistencyResidual> residuals,
                                                             std::span<const std::int64_t> resting) {
  for (Feature& feature : features_) ++feature.quiet;
  for_each_match(features_, residuals, [&](Feature& feature, const ConsistencyResidual& residual) {
    feature.verdict.residual_px = residual.mean_px;
    if (residual.mean_px > config_.quiet_px) feature.quiet = 0;
    if (residual.mean_px > config_.mcc_threshold_px) {
      flag(feature.verdict, VerdictReason::kResidual);
    } else if (residual.compared + 1 >= config_.mcc_min_observations) {
      recycle(feature);
    }
  });
  if (config_.quiet_pictures > 0) {
    for (Feature& feature : features_) {
      if (feature.quiet >= config_.quiet_pictures) recycle(feature);
    }
  }
  for (Feature& feature : features_) {
    if (std::ranges::binary_search(resting, feature.verdict.id)) recycle(feature, VerdictReason::kRested);
  }
  list_verdicts();
  verdicts_ = apply_floor(std::move(verdicts_), config_.min_stable_features);
  return verdicts_;
}

void FeatureRecognition::recycle(Feature& feature, VerdictReason reason) {
  if (!is_dynamic(feature.verdict) || feature.inside_mask) return;
  feature.verdict.verdict = Verdict::kStable;
  feature.verdict.reason = reason;
}

void FeatureRecognition::list_verdicts() {
  verdicts_.clear();
  for (const Feature& feature : features_) verdicts_.push_back(feature.verdict);
}

std::vector<FeatureVerdict> apply_floor(std::vector<FeatureVerdict> verdicts, int min_stable) {
  const auto stable = std::ranges::count_if(verdicts, std::not_fn(is_dynamic));
  for (auto missing = min_stable - stable; missing > 0; --missing) {
    const auto candidate = std::ranges::min_element(verdicts, {}, rank_of);
    if (candidate == verdicts.end() || !may_be_lifted(*candidate)) break;
    candidate->verdict = Verdict::kStable;
    candidate->reason = VerdictReason::kFloor;
  }
  return verdicts;
}

}  // namespace stillpoint
