// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_checks.h"

#include <algorithm>
#include <cmath>

#include "core/config/monitor_config.h"

namespace stillpoint {
namespace {

bool is_recent(const std::optional<Timestamp>& t, Timestamp now, double seconds) {
  return t && seconds_between(*t, now) < seconds;
}

}  // namespace

std::optional<std::size_t> InertialCheck::pose_before(Timestamp t) const {
  for (std::size_t i = poses_.size(); i-- > 0;) {
    if (seconds_between(poses_[i].t, t) >= kMonitor.inertial.interval_s) return i;
  }
  return std::nullopt;
}

/// Of the error over the last two intervals.
std::optional<InertialError> InertialCheck::error_at(const VisualPose& pose, const NavState& state,
                                                     const Eigen::Vector3d& gravity_w, ImuBuffer& imu) {
  const std::optional<std::size_t> middle = pose_before(pose.t);
  if (!middle) return std::nullopt;
  const VisualPose& B = poses_[*middle];
  const std::optional<std::size_t> first = pose_before(B.t);
  if (!first) return std::nullopt;
  return inertial_error(independent_poses(poses_[*first], B, pose), state, gravity_w, imu);
}

bool InertialCheck::update(const VisualPose& pose, const NavState& state, const Eigen::Vector3d& gravity_w,
                           ImuBuffer& imu) {
  if (resume_at_ && pose.t < *resume_at_) return consistent_;
  const std::optional<InertialError> error = error_at(pose, state, gravity_w, imu);
  std::erase_if(poses_, [&](const VisualPose& old) {
    return seconds_between(old.t, pose.t) > kMonitor.inertial.history_s;
  });
  poses_.push_back(pose);
  if (!error) return consistent_;
  const double accel = error->accel_severity(), gyro = error->gyro_severity();
  const bool agrees =
      accel < kMonitor.inertial.agreeing_severity && gyro < kMonitor.inertial.agreeing_severity;
  agreeing_frames_ = agrees ? agreeing_frames_ + 1 : 0;
  const auto has_changed = [&](double severity, bool is_explained, std::optional<Timestamp>& changed_at) {
    if (severity > kMonitor.inertial.min_change_severity && is_explained) changed_at = pose.t;
    return is_recent(changed_at, pose.t, kMonitor.inertial.after_change_s);
  };
  const double larger = std::max(accel, gyro);
  const bool accel_changed =
      has_changed(pose.is_confirmed ? larger : accel, error->accel_is_explained(), accel_changed_at_);
  const bool gyro_changed =
      has_changed(pose.is_confirmed ? larger : gyro, error->gyro_is_explained(), gyro_changed_at_);
  const bool either = pose.is_confirmed && (accel_changed || gyro_changed);
  if (is_wrong(accel, accel_changed || either, pose.t) || is_wrong(gyro, gyro_changed || either, pose.t)) {
    consistent_ = false;
    doubted_since_.reset();
  }
  if (agreeing_frames_ >= kMonitor.inertial.agreeing_frames && !held_) {
    consistent_ = true;
    doubted_since_.reset();
  }
  return consistent_;
}

bool InertialCheck::is_wrong(double severity, bool has_changed, Timestamp now) const {
  if (!std::isfinite(severity)) return true;
  return severity > 1.0 && (has_changed || is_recent(missing_at_, now, kMonitor.inertial.after_gap_s));
}

void InertialCheck::interrupt(Timestamp t) {
  poses_.clear();
  resume_at_ = after(t, kMonitor.inertial.settling_s);
}

void InertialCheck::doubt(Timestamp t) {
  missing_at_ = t;
  agreeing_frames_ = 0;
  if (!consistent_) return;
  consistent_ = false;
  doubted_since_ = t;
}

void InertialCheck::end_old_doubt(Timestamp t) {
  if (!doubted_since_ || is_recent(doubted_since_, t, kMonitor.inertial.max_doubt_s)) return;
  doubted_since_.reset();
  consistent_ = true;
}

void InertialCheck::contradict() {
  consistent_ = false;
  doubted_since_.reset();
  agreeing_frames_ = 0;
}

void InertialCheck::reset() {
  resume_at_.reset();
  accel_changed_at_.reset();
  gyro_changed_at_.reset();
  poses_.clear();
  doubted_since_.reset();
  held_ = false;
  consistent_ = true;
  agreeing_frames_ = 0;
}

namespace {

/// Three views by their indices.
struct Views {
  std::size_t first;
  std::size_t middle;
  std::size_t last;
};

/// The newest view and earlier ones with the given intervals.
std::optional<Views> spaced(const FeatureViews& views, double interval_s) {
  const std::size_t last = views.size() - 1;
  const std::optional<std::size_t> middle = views.before(views[last].t, interval_s);
  if (!middle) return std::nullopt;
  const std::optional<std::size_t> first = views.before(views[*middle].t, interval_s);
  if (!first) return std::nullopt;
  return Views{*first, *middle, last};
}

/// The poses of three views by vision, and the error of the inertial data between them.
struct ViewError {
  VisualPose B;
  VisualPose C;
  InertialError error;
};

/// With the pose of the first view as estimated so far: the others are relative to it.
std::optional<ViewError> error_between(const Views& chosen, FeatureViews& views, const Window& window,
                                       ImuBuffer& imu) {
  const VisualPose A{.t = views[chosen.first].t, .T_w_b = views[chosen.first].T_w_b};
  const std::optional<VisualPose> B = views.pose_after(A, chosen.first, chosen.middle, window.T_b_c);
  if (!B) return std::nullopt;
  const std::optional<VisualPose> C = views.pose_after(*B, chosen.middle, chosen.last, window.T_b_c);
  if (!C) return std::nullopt;
  const std::optional<InertialError> error =
      inertial_error(chained_poses(A, *B, *C), window.frames.back().state, window.gravity_w, imu);
  if (!error) return std::nullopt;
  return ViewError{*B, *C, *error};
}

}  // namespace

/// Whether the mean specific force or angular rate differs between (first, middle] and (middle, newest].
bool StepCheck::data_changed(std::size_t first, std::size_t middle) const {
  Eigen::Vector3d accel[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  Eigen::Vector3d gyro[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = first + 1; i < views_.size(); ++i) {
    accel[i > middle] += views_[i].velocity_w;
    gyro[i > middle] += views_[i].rotation_b;
  }
  const double T1 = seconds_between(views_[first].t, views_[middle].t);
  const double T2 = seconds_between(views_[middle].t, views_[views_.size() - 1].t);
  return (accel[1] / T2 - accel[0] / T1).norm() > kMonitor.step.accel ||
         (gyro[1] / T2 - gyro[0] / T1).norm() > kMonitor.step.gyro;
}

bool StepCheck::is_wrong(const Window& window, ImuBuffer& imu) {
  static_cast<void>(views_.add(window));
  const std::optional<Views> chosen = spaced(views_, kMonitor.inertial.interval_s);
  if (!chosen || !data_changed(chosen->first, chosen->middle)) return false;
  const std::optional<ViewError> found = error_between(*chosen, views_, window, imu);
  if (!found) return false;
  const InertialError& error = found->error;
  const bool accel =
      error.accel_w.norm() > kMonitor.step.accel + kMonitor.step.accel_sigmas * error.accel_sigma;
  const bool gyro = error.gyro_b.norm() > kMonitor.step.gyro + kMonitor.step.gyro_sigmas * error.gyro_sigma;
  return (accel && error.accel_is_explained()) || (gyro && error.gyro_is_explained());
}

namespace {

/// Errors that the longest rule needs.
constexpr std::size_t kMaxErrors = 6;

struct BiasError {
  Eigen::Vector3d e;
  double sigma;
  bool explained;

  [[nodiscard]] bool exceeds(const BiasLimit& limit) const {
    return e.norm() > limit.base + limit.sigmas * sigma;
  }
  [[nodiscard]] bool has_direction_of(const BiasError& other) const {
    return e.dot(other.e) >= kMonitor.bias.min_cosine * e.norm() * other.e.norm();
  }
};

BiasError gyro_bias_error(const MeasuredBiases& measured, const NavState& state) {
  return {measured.gyro - state.gyro_bias, measured.gyro_sigma, measured.gyro_explained};
}

BiasError accel_bias_error(const MeasuredBiases& measured, const NavState& state) {
  return {measured.accel - state.accel_bias, measured.accel_sigma, measured.accel_explained};
}

bool is_certain(const VisualPose& pose, std::size_t tracked) {
  return pose.features >= kMonitor.bias.certain_features &&
         pose.features >= kMonitor.bias.certain_ratio * static_cast<double>(tracked);
}

/// Whether the newest errors of one sensor have one direction and fulfill a rule.
template <class ErrorOf>
bool fulfills(const BiasStepRule& rule, const std::vector<MeasuredBiases>& measured,
              const ErrorOf& error_of) {
  const auto errors = static_cast<std::size_t>(rule.errors);
  if (measured.size() < errors) return false;
  const BiasError newest = error_of(measured.back());
  bool explained = !rule.explained;
  for (std::size_t i = measured.size() - errors; i < measured.size(); ++i) {
    const BiasError error = error_of(measured[i]);
    if (!error.exceeds(rule.limit) || !error.has_direction_of(newest)) return false;
    if (rule.certain && !measured[i].certain) return false;
    explained = explained || error.explained;
  }
  return explained;
}

/// Whether the errors of the gyroscope grow like those of a step of its bias. A measurement that ends at t,
/// of duration T, contains the part min(t - s, T) / T of a step at s. Between the last measurement t_0 with
/// less than half of the newest error e_n, and the next one, the errors e along e_n therefore grow by
///
///   e_1 - e_0 <= |e_n| (t_1 - t_0) / min(t_n - t_0, T).
///
/// Images that are displaced at once, as by another readout, have the whole error in the first measurement,
/// and the same one in all that contain the displacement. The limit is the geometric mean of both cases.
bool grows_like_step(const std::vector<MeasuredBiases>& measured, const NavState& state) {
  const std::size_t newest = measured.size() - 1;
  const Eigen::Vector3d e_n = gyro_bias_error(measured[newest], state).e;
  const auto part = [&](std::size_t i) {
    return gyro_bias_error(measured[i], state).e.dot(e_n) / e_n.squaredNorm();
  };
  std::size_t first = newest;
  while (first > 0 && part(first - 1) >= 0.5) --first;
  if (first == 0 || first == newest) return true;
  const auto since = [&](std::size_t i) { return seconds_between(measured[first - 1].t, measured[i].t); };
  const double span_s = 2.0 * kMonitor.bias.interval_s;
  return part(first) - part(first - 1) <= std::sqrt(since(first) / std::min(since(newest), span_s));
}

bool is_step(const std::vector<MeasuredBiases>& measured, const NavState& state) {
  const auto gyro = [&](const BiasStepRule& rule) {
    return fulfills(rule, measured, [&](const auto& biases) { return gyro_bias_error(biases, state); }) &&
           grows_like_step(measured, state);
  };
  const auto accel = [&](const BiasStepRule& rule) {
    return fulfills(rule, measured, [&](const auto& biases) { return accel_bias_error(biases, state); });
  };
  return std::ranges::any_of(kMonitor.bias.gyro_rules, gyro) ||
         std::ranges::any_of(kMonitor.bias.accel_rules, accel);
}

}  // namespace

BiasCheck::Result BiasCheck::update(const Window& window, ImuBuffer& imu) {
  if (!views_.add(window)) return Result::kUnknown;
  const std::optional<MeasuredBiases> newest = measure(window, imu);
  if (!newest) {
    measured_.clear();
    return Result::kUnknown;
  }
  if (!measured_.empty() && seconds_between(measured_.back().t, newest->t) > kMonitor.bias.max_pause_s)
    measured_.clear();
  if (measured_.size() == kMaxErrors) measured_.erase(measured_.begin());
  measured_.push_back(*newest);
  const NavState& state = window.frames.back().state;
  const BiasError gyro = gyro_bias_error(*newest, state), accel = accel_bias_error(*newest, state);
  const bool agrees =
      !gyro.exceeds(kMonitor.bias.gyro_agreement) && !accel.exceeds(kMonitor.bias.accel_agreement);
  if (!agrees && is_step(measured_, state)) return Result::kStep;
  const bool differs =
      gyro.exceeds(kMonitor.bias.gyro_difference) || accel.exceeds(kMonitor.bias.accel_difference);
  if (!newest->certain) return differs ? Result::kDoubtful : Result::kUnknown;
  if (agrees) return Result::kAgrees;
  return differs ? Result::kDiffers : Result::kUnknown;
}

std::optional<MeasuredBiases> BiasCheck::measure(const Window& window, ImuBuffer& imu) {
  const std::optional<Views> chosen = spaced(views_, kMonitor.bias.interval_s);
  if (!chosen) return std::nullopt;
  const std::optional<ViewError> found = error_between(*chosen, views_, window, imu);
  if (!found) return std::nullopt;
  const auto& [B, C, error] = *found;
  const NavState& state = window.frames.back().state;
  return MeasuredBiases{.t = C.t,
                        .gyro = state.gyro_bias + error.gyro_b,
                        .accel = state.accel_bias + B.T_w_b.q.conjugate() * error.accel_w,
                        .gyro_sigma = error.gyro_sigma,
                        .accel_sigma = error.accel_sigma,
                        .certain = is_certain(B, views_[chosen->middle].points.size()) &&
                                   is_certain(C, views_[chosen->last].points.size()),
                        .gyro_explained = error.gyro_is_explained(),
                        .accel_explained = error.accel_is_explained()};
}

}  // namespace stillpoint
