// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/calibrate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "core/base/error.h"
#include "core/calibration/batch_problem.h"
#include "core/calibration/batch_state.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

using enum SharedValue;

constexpr int kRounds = 4;
// The depth image is read, and edges are matched, at another place in each. On 7-Scenes redkitchen T_c_d
// still moves by 7 mm in the rounds 15 to 20, and by 1 mm in the next three.
constexpr int kRoundsOfTwoCameras = 20;
constexpr int kRoundsAfterHalves = 2;
constexpr double kFirstEdgeRadius_px = 12.0;  // in which edges are matched, in the second round
constexpr double kEdgeRadius_px = 4.0;        // likewise in the last ones
constexpr std::size_t kMinKeyframes = 10;
constexpr std::size_t kMinLandmarks = 50;
constexpr double kObservedRatio = 0.5;  // of deviation and prior, below which a value is observed
constexpr double kDifferentSigmas = 3.0;
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Description of a shared value. The systematic deviations are those of recordings of 640x480 pixels whose
/// halves agree: tracking has a bias of up to half a pixel on rendered sequences with an exact calibration.
/// That of the depth scale is what recorded accelerometers, to which it is compared, are off.
struct SharedDescription {
  const char* name;
  const char* unit;
  double factor;      ///< from SI units
  double systematic;  ///< deviation that no residual shows, in SI units; of focal lengths: relative
};
constexpr double kSystematicWidth_px = 640.0;

constexpr std::array<SharedDescription, kSharedCount> kDescriptions = {{
    {"fx", "px", 1.0, 7e-4},
    {"fy", "px", 1.0, 7e-4},
    {"cx", "px", 1.0, 0.4},
    {"cy", "px", 1.0, 0.4},
    {"k1", "", 1.0, 1e-3},
    {"k2", "", 1.0, 2e-3},
    {"rolling_shutter_s", "ms", 1e3, 3e-4},
    {"depth scale", "", 1.0, 1e-2},
    {"depth offset", "1/m", 1.0, 1e-3},
    {"depth fx", "px", 1.0, 2e-3},
    {"depth fy", "px", 1.0, 2e-3},
    {"depth cx", "px", 1.0, 1.0},
    {"depth cy", "px", 1.0, 1.0},
    {"T_c_d x", "mm", 1e3, 1e-3},
    {"T_c_d y", "mm", 1e3, 1e-3},
    {"T_c_d z", "mm", 1e3, 1e-3},
    {"T_c_d rotation x", "deg", kDegrees, 3e-4},
    {"T_c_d rotation y", "deg", kDegrees, 3e-4},
    {"T_c_d rotation z", "deg", kDegrees, 3e-4},
    {"T_b_c x", "mm", 1e3, 2e-3},
    {"T_b_c y", "mm", 1e3, 2e-3},
    {"T_b_c z", "mm", 1e3, 2e-3},
    {"T_b_c rotation x", "deg", kDegrees, 3e-4},
    {"T_b_c rotation y", "deg", kDegrees, 3e-4},
    {"T_b_c rotation z", "deg", kDegrees, 3e-4},
    {"time_offset_s", "ms", 1e3, 2e-4},
    {"gyro scale x", "%", 1e2, 7e-4},
    {"gyro scale y", "%", 1e2, 7e-4},
    {"gyro scale z", "%", 1e2, 7e-4},
    {"gyro axes xy", "deg", kDegrees, 3e-4},
    {"gyro axes xz", "deg", kDegrees, 3e-4},
    {"gyro axes yz", "deg", kDegrees, 3e-4},
    {"accel scale x", "%", 1e2, 5e-4},
    {"accel scale y", "%", 1e2, 5e-4},
    {"accel scale z", "%", 1e2, 5e-4},
    {"accel axes xy", "deg", kDegrees, 3e-4},
    {"accel axes xz", "deg", kDegrees, 3e-4},
    {"accel axes yz", "deg", kDegrees, 3e-4},
    {"depth delay", "ms", 1e3, 1e-3},
    {"truth T_f_b x", "mm", 1e3, 1e-3},
    {"truth T_f_b y", "mm", 1e3, 1e-3},
    {"truth T_f_b z", "mm", 1e3, 1e-3},
    {"truth T_f_b rotation x", "deg", kDegrees, 3e-4},
    {"truth T_f_b rotation y", "deg", kDegrees, 3e-4},
    {"truth T_f_b rotation z", "deg", kDegrees, 3e-4},
    {"truth delay", "ms", 1e3, 2e-4},
}};

/// A bias in pixels is a larger angle, and a larger fraction of the focal length, in a smaller image; so is
/// what is compared with angles: the lever arm by the motion that it causes, the axes of inertial sensors by
/// the turns of the camera.
double systematic_sigma(SharedValue value, const RigCalibration& stated) {
  const SharedValues values = shared_values(stated);
  const double sigma = kDescriptions[static_cast<std::size_t>(value)].systematic;
  const auto scale = [](const Camera& camera) { return std::max(1.0, kSystematicWidth_px / camera.width); };
  const double color = scale(stated.rig.camera);
  if (value == kFx || value == kFy) return color * sigma * values.camera[value == kFx ? 0 : 1];
  if (value == kDepthFx || value == kDepthFy)
    return scale(stated.depth_camera) * sigma * values.depth_camera[value == kDepthFx ? 0 : 1];
  const auto is_of = [value](SharedValue first, int begin, int end) {
    const int component = static_cast<int>(value) - static_cast<int>(first);
    return component >= begin && component < end;
  };
  const bool is_scaled = value == kK1 || value == kK2 || is_of(kDepthPose, 3, 6) ||
                         is_of(kExtrinsics, 0, 6) || is_of(kImuAxes, 0, kImuAxesCount) ||
                         is_of(kTruthPose, 3, 6);
  return is_scaled ? color * sigma : sigma;
}

void set(SharedFlags& flags, SharedValue first, int count, bool value) {
  std::fill_n(flags.begin() + static_cast<int>(first), count, value);
}

/// The values that the data can determine at all.
SharedFlags variable_values(const CalibrationSwitches& estimate, const CalibrationInput& input) {
  const bool inertial = !input.imu.empty(), has_truth = !input.truth.trajectory.poses.empty();
  SharedFlags flags{};
  set(flags, kFx, 2, estimate.focal);
  set(flags, kCx, 2, estimate.center);
  set(flags, kK1, 2, estimate.distortion);
  set(flags, kReadout, 1, estimate.rolling_shutter);
  set(flags, kDepthScale, 1, estimate.depth_scale && (inertial || has_truth));
  set(flags, kDepthOffset, 1, estimate.depth_offset);
  set(flags, kDepthFx, 2, estimate.depth_intrinsics && !input.depth_is_registered);
  set(flags, kDepthCx, 2, estimate.depth_intrinsics);
  set(flags, kDepthPose, 6, estimate.depth_pose && !input.depth_is_registered);
  set(flags, kDepthDelay, 1, estimate.depth_pose && !input.depth_is_registered);
  set(flags, kExtrinsics, 6, estimate.extrinsics && inertial);
  set(flags, kTimeOffset, 1, estimate.time_offset && inertial);
  set(flags, kImuAxes, kImuAxesCount, estimate.imu_intrinsics && inertial);
  set(flags, kTruthPose, 7, has_truth);
  return flags;
}

/// The numbers of the shared values; rotations relative to the stated ones.
SharedVector vector_of(const SharedValues& shared, const RigCalibration& stated) {
  SharedVector v = SharedVector::Zero();
  std::copy_n(shared.camera.begin(), 6, v.data());
  v[static_cast<int>(kReadout)] = shared.readout_s;
  std::ranges::copy(shared.depth, v.data() + static_cast<int>(kDepthScale));
  std::ranges::copy(shared.depth_camera, v.data() + static_cast<int>(kDepthFx));
  const auto add_pose = [&](SharedValue first, const Pose& pose, const Pose& from) {
    v.segment<3>(static_cast<int>(first)) = pose.p;
    v.segment<3>(static_cast<int>(first) + 3) = log_so3(from.q.conjugate() * pose.q);
  };
  add_pose(kDepthPose, pose_of(shared.T_c_d), stated.T_c_d);
  add_pose(kExtrinsics, pose_of(shared.T_b_c), stated.rig.T_b_c);
  v[static_cast<int>(kTimeOffset)] = shared.time_offset_s;
  std::ranges::copy(shared.imu_axes, v.data() + static_cast<int>(kImuAxes));
  v[static_cast<int>(kDepthDelay)] = shared.depth_delay_s;
  add_pose(kTruthPose, pose_of(shared.T_f_b), Pose{});
  v[static_cast<int>(kTruthDelay)] = shared.truth_delay_s;
  return v;
}

SharedVector prior_sigmas(const CalibrationPriors& priors, const RigCalibration& stated) {
  SharedVector s;
  Eigen::Matrix<double, 6, 1> axes;
  axes << Eigen::Vector3d::Constant(priors.imu_scale), Eigen::Vector3d::Constant(priors.imu_axes_rad);
  const Camera& camera = stated.rig.camera;
  s << priors.focal * camera.fx, priors.focal * camera.fy, priors.center_px, priors.center_px,
      priors.distortion, priors.distortion, priors.rolling_shutter_s, priors.depth_scale, priors.depth_offset,
      priors.depth_focal * stated.depth_camera.fx, priors.depth_focal * stated.depth_camera.fy,
      priors.depth_center_px, priors.depth_center_px, Eigen::Vector3d::Constant(priors.lever_m),
      Eigen::Vector3d::Constant(priors.rotation_rad), Eigen::Vector3d::Constant(priors.lever_m),
      Eigen::Vector3d::Constant(priors.rotation_rad), priors.time_offset_s, axes, axes, priors.depth_delay_s,
      Eigen::Vector3d::Constant(priors.truth_position_m),
      Eigen::Vector3d::Constant(priors.truth_rotation_rad), priors.truth_delay_s;
  return s;
}

/// Solution of one part of the recording.
struct Solution {
  BatchState state;
  RoundStatistics statistics;
  std::optional<SharedVector> sigmas;
  bool usable = true;
};

/// Runs rounds, counts them, and passes the progress on.
class Rounds {
 public:
  Rounds(const CalibrationInput& input, const CalibrationOptions& options)
      : input_(input), options_(options), priors_(options.priors) {}

  /// Weights the priors as if the data had larger deviations by this factor.
  void weaken_data(double factor) {
    CalibrationPriors& p = priors_;
    for (double* const sigma :
         {&p.focal, &p.focal_ratio, &p.center_px, &p.distortion, &p.rolling_shutter_s, &p.depth_scale,
          &p.depth_offset, &p.depth_focal, &p.depth_center_px, &p.rotation_rad, &p.lever_m, &p.time_offset_s,
          &p.imu_scale, &p.imu_axes_rad, &p.depth_delay_s, &p.truth_rotation_rad, &p.truth_position_m,
          &p.truth_delay_s})
      *sigma /= factor;
  }

  /// Number of rounds of a solution that estimates the calibration; with a constant one `kRounds`.
  [[nodiscard]] int count() const { return input_.depth_is_registered ? kRounds : kRoundsOfTwoCameras; }
  void set_steps(int steps) { progress_.steps = steps; }
  [[nodiscard]] bool interrupted() const { return interrupted_; }

  /// From the initial values of `state`, by `count` rounds.
  [[nodiscard]] Solution solve(BatchState state, const SharedFlags& is_variable) {
    Solution solution{.state = std::move(state)};
    const bool is_constant = std::ranges::none_of(is_variable, std::identity{});
    const int rounds = is_constant ? kRounds : count();
    for (int round = 0; round < rounds && solution.usable && !interrupted_; ++round) {
      run_round(solution, is_variable, round);
    }
    return solution;
  }

  /// One more round, with other constant values.
  void run_round(Solution& solution, const SharedFlags& is_variable, int number) {
    const RoundOptions round{
        .is_variable = is_variable,
        .is_first = number == 0,
        .depth_is_registered = input_.depth_is_registered,
        .edge_radius_px = edge_radius_px(number),
        .max_iterations = 25,
        .on_iteration = [this](int iteration, double cost) { return report(iteration, cost); }};
    BatchProblem problem(input_, priors_, round, solution.state);
    solution.usable = problem.solve();
    solution.statistics = problem.update_deviations();
    ++progress_.step;
  }

  /// Standard deviations at the present values and deviations of the residuals.
  [[nodiscard]] std::optional<SharedVector> deviations(Solution& solution,
                                                       const SharedFlags& is_variable) const {
    const RoundOptions round{.is_variable = is_variable,
                             .depth_is_registered = input_.depth_is_registered,
                             .edge_radius_px = edge_radius_px(count())};
    return BatchProblem(input_, priors_, round, solution.state).deviations();
  }

 private:
  /// None in the first round, whose calibration may be off by tens of pixels.
  static double edge_radius_px(int round) {
    return round == 0 ? 0.0 : std::max(kEdgeRadius_px, kFirstEdgeRadius_px / round);
  }
  bool report(int iteration, double cost) {
    progress_.iteration = iteration;
    progress_.cost = cost;
    if (options_.on_iteration && !options_.on_iteration(progress_)) interrupted_ = true;
    return !interrupted_;
  }

  const CalibrationInput& input_;
  const CalibrationOptions& options_;
  CalibrationPriors priors_;
  CalibrationProgress progress_;
  bool interrupted_ = false;
};

void require_content(const CalibrationInput& input, const BatchState& state) {
  if (state.keyframes.size() < kMinKeyframes) {
    throw InputError("calibration",
                     "the odometry located only " + std::to_string(state.keyframes.size()) + " keyframes, " +
                         std::to_string(kMinKeyframes) +
                         " are needed; use a longer recording, or correct the rig so that it is tracked");
  }
  if (state.landmarks.size() < kMinLandmarks) {
    throw InputError("calibration", "only " + std::to_string(state.landmarks.size()) + " static points, " +
                                        std::to_string(kMinLandmarks) +
                                        " are needed; record a scene with more texture, in motion");
  }
  const bool has_depth = std::ranges::any_of(state.landmarks, [](const BatchLandmark& landmark) {
    return std::ranges::any_of(landmark.observations,
                               [](const BatchObservation& seen) { return seen.feature.depth_m > 0.0; });
  });
  const CalibrationTruth& truth = input.truth;
  const auto known =
      static_cast<std::size_t>(std::ranges::count_if(state.keyframes, [&](const BatchKeyframe& keyframe) {
        return truth_at(truth.trajectory, after(keyframe.t, truth.delay_s)).has_value();
      }));
  if (!truth.trajectory.poses.empty() && known < kMinKeyframes)
    throw InputError("calibration", "the ground truth is known at only " + std::to_string(known) + " of " +
                                        std::to_string(state.keyframes.size()) + " keyframes, " +
                                        std::to_string(kMinKeyframes) +
                                        " are needed; give that of this recording, by the same clock");
  if (!has_depth && input.imu.empty())
    throw InputError("calibration", "needs depth images or an IMU: images alone have no metric scale");
}

/// Values with a deviation that is clearly smaller than that of the prior.
SharedFlags observed_values(const SharedVector& sigmas, const SharedVector& priors,
                            const SharedFlags& is_variable) {
  SharedFlags observed{};
  for (int i = 0; i < kSharedCount; ++i) {
    const auto k = static_cast<std::size_t>(i);
    observed[k] = is_variable[k] && sigmas[i] > 0.0 && sigmas[i] < kObservedRatio * priors[i];
  }
  return observed;
}

/// Means of gyroscope and accelerometer over consecutive intervals.
std::vector<std::array<Eigen::Vector3d, 2>> inertial_means(std::span<const ImuSample> samples,
                                                           double interval_s) {
  std::vector<std::array<Eigen::Vector3d, 2>> means;
  for (std::size_t first = 0, i = 0; i < samples.size(); ++i) {
    if (seconds_between(samples[first].t, samples[i].t) < interval_s) continue;
    std::array<Eigen::Vector3d, 2> mean = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    for (const ImuSample& sample : samples.subspan(first, i - first)) {
      mean[0] += sample.gyro_b / static_cast<double>(i - first);
      mean[1] += sample.accel_b / static_cast<double>(i - first);
    }
    means.push_back(mean);
    first = i;
  }
  return means;
}

/// Whether the means of a sensor over 0.05 s change within 0.5 s by more than from one to the next, as those
/// of white noise do not. Of a camera that does not move, noise alone would seem to show the time offset,
/// which is estimated from such changes, and the readout time, which is estimated from velocities in the
/// image.
bool shows_motion(std::span<const ImuSample> samples) {
  constexpr std::size_t kLag = 10;
  constexpr double kMinRatio = 2.0;  // of squares
  const auto means = inertial_means(samples, 0.05);
  std::array<double, 2> slow{}, fast{};
  for (std::size_t i = kLag; i < means.size(); ++i) {
    for (std::size_t sensor = 0; sensor < 2; ++sensor) {
      slow[sensor] += (means[i][sensor] - means[i - kLag][sensor]).squaredNorm();
      fast[sensor] += (means[i][sensor] - means[i - 1][sensor]).squaredNorm();
    }
  }
  return slow[0] > kMinRatio * fast[0] || slow[1] > kMinRatio * fast[1];
}

/// Makes numbers constant that are not observed, with their stated values; poses are kept. The readout time
/// as well if it agrees with the stated one: a global shutter stays one.
/// @return whether there are any
bool set_back_unobserved(Solution& solution, const RigCalibration& stated, const SharedFlags& observed,
                         SharedFlags& is_variable) {
  const SharedValues from = shared_values(stated);
  SharedValues& to = solution.state.shared;
  const SharedVector& sigmas = *solution.sigmas;
  const double readout_sigma_s =
      std::hypot(sigmas[static_cast<int>(kReadout)], systematic_sigma(kReadout, stated));
  const bool readout_agrees = std::abs(to.readout_s - from.readout_s) < kDifferentSigmas * readout_sigma_s;
  bool changed = false;
  const auto visit = [&](SharedValue value, double& number, double stated_number) {
    const auto k = static_cast<std::size_t>(value);
    if (!is_variable[k] || (observed[k] && !(value == kReadout && readout_agrees))) return;
    is_variable[k] = false;
    number = stated_number;
    changed = true;
  };
  for (std::size_t i = 0; i < 6; ++i) visit(static_cast<SharedValue>(i), to.camera[i], from.camera[i]);
  visit(kReadout, to.readout_s, from.readout_s);
  visit(kDepthScale, to.depth[0], from.depth[0]);
  visit(kTimeOffset, to.time_offset_s, from.time_offset_s);
  visit(kDepthDelay, to.depth_delay_s, from.depth_delay_s);
  return changed;
}

/// Of the second half, with its poses and landmarks estimated at constant calibrations.
HeldOutResiduals held_out_residuals(Rounds& rounds, const CalibrationInput& input,
                                    const SharedValues& found) {
  BatchState state = initial_state(input, 0.5, 1.0);
  RoundStatistics before = rounds.solve(state, SharedFlags{}).statistics;
  state.shared = found;
  RoundStatistics after = rounds.solve(std::move(state), SharedFlags{}).statistics;
  return {.pixel_before_px = before.pixel_rms_px,
          .pixel_after_px = after.pixel_rms_px,
          .depth_before = before.inverse_depth_rms,
          .depth_after = after.inverse_depth_rms,
          .before = std::move(before.residuals),
          .after = std::move(after.residuals)};
}

/// By how much more the halves differ than their deviations say; at least 1.
double deviation_factor(const std::array<Solution, 2>& halves, const RigCalibration& stated,
                        const SharedVector& priors) {
  if (!halves[0].sigmas || !halves[1].sigmas) return 1.0;
  const SharedVector difference =
      vector_of(halves[0].state.shared, stated) - vector_of(halves[1].state.shared, stated);
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kSharedCount; ++i) {
    const double a = (*halves[0].sigmas)[i], b = (*halves[1].sigmas)[i];
    if (a <= 0.0 || b <= 0.0 || std::max(a, b) > kObservedRatio * priors[i]) continue;
    sum += difference[i] * difference[i] / (a * a + b * b);
    ++count;
  }
  return count == 0 ? 1.0 : std::max(1.0, std::sqrt(sum / count));
}

ParameterOutcome outcome_of(double difference, double sigma, bool observed) {
  if (!observed) return ParameterOutcome::kNotObserved;
  return std::abs(difference) > kDifferentSigmas * sigma ? ParameterOutcome::kDiffers
                                                         : ParameterOutcome::kAgrees;
}

InertialBiases biases_of(const std::vector<BatchKeyframe>& keyframes) {
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero(), squares = sum;
  const auto count = static_cast<double>(keyframes.size());
  for (const BatchKeyframe& keyframe : keyframes)
    sum += Eigen::Map<const Eigen::Matrix<double, 6, 1>>(keyframe.speed_bias.data() + 3) / count;
  for (const BatchKeyframe& keyframe : keyframes)
    squares +=
        (Eigen::Map<const Eigen::Matrix<double, 6, 1>>(keyframe.speed_bias.data() + 3) - sum).cwiseAbs2() /
        count;
  const Eigen::Matrix<double, 6, 1> spread = squares.cwiseSqrt();
  return {sum.head<3>(), spread.head<3>(), sum.tail<3>(), spread.tail<3>()};
}

/// Estimation of the whole recording, then of its halves.
class Calibration {
 public:
  Calibration(const CalibrationInput& input, const CalibrationOptions& options)
      : input_(input),
        options_(options),
        rounds_(input, options),
        priors_(prior_sigmas(options.priors, input.stated)),
        is_variable_(variable_values(options.estimate, input)) {
    rounds_.set_steps((options.hold_out ? 3 * rounds_.count() + 2 * kRounds : rounds_.count()) + 1 +
                      kRoundsAfterHalves + 1);
  }

  [[nodiscard]] CalibrationResult run() {
    solution_.state = initial_state(input_, 0.0, 1.0);
    require_content(input_, solution_.state);
    result_.keyframes = solution_.state.keyframes.size();
    const SharedFlags wanted = is_variable_;
    estimate_all();
    if (options_.hold_out && !rounds_.interrupted() && solution_.sigmas) estimate_halves();
    set_back_last();
    describe();
    list_parameters(wanted);
    return std::move(result_);
  }

 private:
  void estimate_all() {
    solution_ = rounds_.solve(std::move(solution_.state), is_variable_);
    if (solution_.usable) solution_.sigmas = rounds_.deviations(solution_, is_variable_);
    if (!solution_.sigmas) return;
    observed_ = observed_values(*solution_.sigmas, priors_, is_variable_);
    if (!input_.imu.empty() && !shows_motion(input_.imu)) {
      set(observed_, kTimeOffset, 1, false);
      set(observed_, kReadout, 1, false);
    }
    if (rounds_.interrupted() || !set_back_unobserved(solution_, input_.stated, observed_, is_variable_))
      return;
    rounds_.run_round(solution_, is_variable_, rounds_.count());
    update_deviations();
  }

  /// Constant values keep the deviations that they had when they were variable.
  void update_deviations() {
    const SharedVector before = *solution_.sigmas;
    solution_.sigmas = rounds_.deviations(solution_, is_variable_);
    if (!solution_.sigmas) return;
    for (int i = 0; i < kSharedCount; ++i) {
      if (!is_variable_[static_cast<std::size_t>(i)]) (*solution_.sigmas)[i] = before[i];
    }
  }

  void estimate_halves() {
    std::array<Solution, 2> halves = {rounds_.solve(initial_state(input_, 0.0, 0.5), is_variable_),
                                      rounds_.solve(initial_state(input_, 0.5, 1.0), is_variable_)};
    for (Solution& half : halves) {
      if (half.usable) half.sigmas = rounds_.deviations(half, is_variable_);
    }
    result_.deviation_factor = deviation_factor(halves, input_.stated, priors_);
    result_.held_out = held_out_residuals(rounds_, input_, halves[0].state.shared);
    result_.has_held_out = !rounds_.interrupted();
    if (rounds_.interrupted() || result_.deviation_factor == 1.0) return;
    rounds_.weaken_data(result_.deviation_factor);
    for (int i = 0; i < kRoundsAfterHalves; ++i) rounds_.run_round(solution_, is_variable_, rounds_.count());
    update_deviations();
    if (solution_.sigmas)
      observed_ = observed_values(result_.deviation_factor * *solution_.sigmas, priors_, observed_);
  }

  /// Axes of the inertial sensors, offset of the depth and center of registered depth images that are not
  /// observed get the stated values, in one more round. The deviations of the other values are those before
  /// it: they contain the errors of these stated values, by their priors.
  void set_back_last() {
    if (!solution_.sigmas || rounds_.interrupted()) return;
    const SharedValues from = shared_values(input_.stated);
    SharedValues& to = solution_.state.shared;
    bool changed = false;
    const auto visit = [&](SharedValue value, double& number, double stated_number) {
      const auto k = static_cast<std::size_t>(value);
      if (!is_variable_[k] || observed_[k]) return;
      is_variable_[k] = false;
      number = stated_number;
      changed = true;
    };
    for (std::size_t i = 0; i < std::size_t{kImuAxesCount}; ++i)
      visit(static_cast<SharedValue>(static_cast<std::size_t>(kImuAxes) + i), to.imu_axes[i], 0.0);
    visit(kDepthOffset, to.depth[1], from.depth[1]);
    if (input_.depth_is_registered) {
      visit(kDepthCx, to.depth_camera[2], from.depth_camera[2]);
      visit(kDepthCy, to.depth_camera[3], from.depth_camera[3]);
    }
    if (changed) rounds_.run_round(solution_, is_variable_, rounds_.count());
  }

  void describe() {
    result_.usable = solution_.usable && solution_.sigmas.has_value();
    result_.interrupted = rounds_.interrupted();
    result_.calibration = rig_calibration(solution_.state.shared, input_.stated);
    result_.landmarks = solution_.statistics.landmarks;
    result_.observations = solution_.statistics.observations;
    result_.depths = solution_.statistics.depths;
    result_.inertial_factors = solution_.statistics.inertial_factors;
    result_.pixel_sigma_px = solution_.state.pixel_sigma_px;
    result_.inverse_depth_sigma = solution_.state.inverse_depth_sigma;
    result_.imu_noise = solution_.state.imu_noise;
    if (result_.inertial_factors > 0) result_.biases = biases_of(solution_.state.keyframes);
    result_.rest = resting_noise(input_.imu);
    result_.truth_poses = solution_.statistics.truth_poses;
    result_.truth_sigma_m = solution_.state.truth_sigma_m;
    result_.truth_sigma_rad = solution_.state.truth_sigma_rad;
  }

  void list_parameters(SharedFlags listed) {
    SharedVector values = vector_of(solution_.state.shared, input_.stated);
    SharedVector stated = vector_of(shared_values(input_.stated), input_.stated);
    const bool has_depth = result_.depths > 0;
    set(listed, kDepthScale, 1, options_.estimate.depth_scale && has_depth);
    set(listed, kDepthOffset, 1, options_.estimate.depth_offset && has_depth);
    for (SharedVector* const offset : {&values, &stated})
      (*offset)[static_cast<int>(kDepthOffset)] += input_.stated.rig.depth_offset;
    if (input_.depth_is_registered) {  // how far the depth image is displaced
      set(listed, kDepthCx, 2, options_.estimate.depth_intrinsics && has_depth);
      const auto center = Eigen::seqN(static_cast<int>(kDepthCx), 2);
      values(center) -= stated(center).eval();
      stated(center).setZero();
    }
    for (int i = 0; i < kSharedCount; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!listed[k]) continue;
      const SharedDescription& description = kDescriptions[k];
      const bool is_observed = solution_.sigmas && observed_[k];
      const double systematic = systematic_sigma(static_cast<SharedValue>(i), input_.stated);
      const double sigma = is_observed
                               ? std::hypot(result_.deviation_factor * (*solution_.sigmas)[i], systematic)
                               : priors_[i];
      result_.parameters.push_back({.name = name_of(static_cast<SharedValue>(i)),
                                    .unit = description.unit,
                                    .value = description.factor * values[i],
                                    .sigma = description.factor * sigma,
                                    .stated = description.factor * stated[i],
                                    .prior_sigma = description.factor * priors_[i],
                                    .outcome = outcome_of(values[i] - stated[i], sigma, is_observed)});
    }
  }

  [[nodiscard]] std::string name_of(SharedValue value) const {
    if (input_.depth_is_registered && value == kDepthCx) return "depth shift x";
    if (input_.depth_is_registered && value == kDepthCy) return "depth shift y";
    return kDescriptions[static_cast<std::size_t>(value)].name;
  }

  const CalibrationInput& input_;
  const CalibrationOptions& options_;
  Rounds rounds_;
  SharedVector priors_;
  SharedFlags is_variable_;
  SharedFlags observed_{};
  Solution solution_;
  CalibrationResult result_;
};

}  // namespace

CalibrationResult calibrate(const CalibrationInput& input, const CalibrationOptions& options) {
  return Calibration(input, options).run();
}

}  // namespace stillpoint
