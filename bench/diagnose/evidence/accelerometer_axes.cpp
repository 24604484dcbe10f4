// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/evidence/accelerometer_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace stillpoint::bench {
namespace {

constexpr double kInterval_s = 0.2;
constexpr double kShortInterval_s = 0.05;  ///< of a vibration, which positions of the ground truth resolve
constexpr double kMostLag_s = 0.2, kLagStepOfAxes_s = 0.005;
constexpr double kBlock_s = 1.5;
constexpr double kMinCorrelation = 0.7;
constexpr double kFollows = 0.9;  ///< correlation of a block that determines the scale
constexpr std::size_t kLeastBlocks = 4;
constexpr double kBetter = 0.25;  ///< least difference of the correlations of other axes and the stated ones

using Linear = Eigen::Matrix<double, 3, 9>;  ///< from the rows of A to the right side

/// Both sides over one triple of times.
struct Sides {
  Eigen::Vector3d images;
  Linear inertial;
  double weight = 0.0;  ///< integral of w
};

/// Consecutive frames with their poses by images.
struct Block {
  std::vector<Timestamp> times;
  std::vector<Pose> poses;  ///< of the camera in the first one
};

void erase_short(std::vector<Block>& blocks) {
  std::erase_if(blocks, [](const Block& block) {
    return seconds_between(block.times.front(), block.times.back()) < 0.6 * kBlock_s;
  });
}

std::vector<Block> blocks_of(const RecordingSurvey& survey) {
  std::vector<Block> blocks;
  for (const FrameStatistics& frame : survey.frames) {
    const bool continues = frame.T_now_last && !frame.same_image && !blocks.empty() &&
                           seconds_between(blocks.back().times.front(), frame.t) < kBlock_s;
    if (!continues) blocks.emplace_back();
    Block& block = blocks.back();
    block.poses.push_back(continues ? block.poses.back() * frame.T_now_last->inverse() : Pose{});
    block.times.push_back(frame.t);
  }
  erase_short(blocks);
  return blocks;
}

/// Of the ground truth during the frames.
std::vector<Block> true_blocks(const datasets::SequenceInfo& info) {
  const Pose T_f_c = info.ground_truth.T_c_f.inverse();
  std::vector<Block> blocks;
  for (const StampedPose& pose : info.ground_truth.trajectory.poses) {
    if (pose.t < info.frame_times.front() || pose.t > info.frame_times.back()) continue;
    const bool continues = !blocks.empty() &&
                           seconds_between(blocks.back().times.back(), pose.t) < kShortInterval_s &&
                           seconds_between(blocks.back().times.front(), pose.t) < kBlock_s;
    if (!continues) blocks.emplace_back();
    blocks.back().times.push_back(pose.t);
    blocks.back().poses.push_back(pose.T_w_f * T_f_c);
  }
  erase_short(blocks);
  return blocks;
}

/// How both sides are compared.
struct Sampling {
  double interval_s = kInterval_s;
  double offset_s = 0.0;  ///< stamp of the IMU minus that of the poses
};

/// The times at the positions i < j < k of a block.
Sides sides_at(const datasets::SequenceInfo& info, const Block& block, const std::array<std::size_t, 3>& at,
               double offset_s) {
  const auto [i, j, k] = at;
  const double before_s = seconds_between(block.times[i], block.times[j]);
  const double behind_s = seconds_between(block.times[j], block.times[k]);
  const Eigen::Matrix3d R_c_b = info.rig.T_b_c.R().transpose();
  Sides sides{.images = (block.poses[k].p - block.poses[j].p) / behind_s -
                        (block.poses[j].p - block.poses[i].p) / before_s,
              .inertial = Linear::Zero(),
              .weight = 0.5 * (before_s + behind_s)};
  double sum = 0.0;
  auto sample = std::ranges::lower_bound(info.imu, after(block.times[i], offset_s), {}, &ImuSample::t);
  for (; sample != info.imu.end(); ++sample) {
    const Timestamp t = after(sample->t, -offset_s);
    if (t >= block.times[k]) break;
    const double w = t < block.times[j] ? seconds_between(block.times[i], t) / before_s
                                        : seconds_between(t, block.times[k]) / behind_s;
    const auto next = std::ranges::upper_bound(block.times, t);
    const std::size_t to = std::clamp<std::size_t>(static_cast<std::size_t>(next - block.times.begin()), 1,
                                                   block.times.size() - 1);
    const double fraction =
        seconds_between(block.times[to - 1], t) / seconds_between(block.times[to - 1], block.times[to]);
    const Eigen::Matrix3d R = block.poses[to - 1].q.slerp(fraction, block.poses[to].q) * R_c_b;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        sides.inertial.col(3 * row + column) += w * R.col(row) * sample->accel_b[column];
    }
    sum += w;
  }
  if (sum > 0.0) sides.inertial *= sides.weight / sum;
  return sides;
}

/// Both sides of a block without the part of gravity.
std::vector<Sides> sides_of(const datasets::SequenceInfo& info, const Block& block,
                            const Sampling& sampling) {
  std::vector<Sides> all;
  const double interval_s =
      seconds_between(block.times.front(), block.times.back()) / static_cast<double>(block.times.size() - 1);
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(sampling.interval_s / interval_s)));
  for (std::size_t j = step; j + step < block.times.size(); ++j)
    all.push_back(sides_at(info, block, {j - step, j, j + step}, sampling.offset_s));
  Sides along{.images = Eigen::Vector3d::Zero(), .inertial = Linear::Zero()};
  for (const Sides& sides : all) {
    along.images += sides.weight * sides.images;
    along.inertial += sides.weight * sides.inertial;
    along.weight += sides.weight * sides.weight;
  }
  for (Sides& sides : all) {
    sides.images -= sides.weight / along.weight * along.images;
    sides.inertial -= sides.weight / along.weight * along.inertial;
  }
  return all;
}

/// Sums of products of both sides, over the blocks.
struct Sums {
  double images = 0.0, both = 0.0, inertial = 0.0;
  [[nodiscard]] double correlation() const {
    return images > 0.0 && inertial > 0.0 ? both / std::sqrt(images * inertial) : 0.0;
  }
};

/// @param least correlation of the blocks that are used: a person who fills the image moves unlike the IMU
Sums sums_of(const std::vector<std::vector<Sides>>& blocks, const Eigen::Matrix3d& P, double least) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = P;
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> vector(rows.data());
  Sums all;
  for (const std::vector<Sides>& block : blocks) {
    Sums sums;
    for (const Sides& sides : block) {
      const Eigen::Vector3d inertial = sides.inertial * vector;
      sums.images += sides.images.squaredNorm();
      sums.both += sides.images.dot(inertial);
      sums.inertial += inertial.squaredNorm();
    }
    if (sums.correlation() < least) continue;
    all.images += sums.images;
    all.both += sums.both;
    all.inertial += sums.inertial;
  }
  return all;
}

std::vector<std::vector<Sides>> all_sides(const datasets::SequenceInfo& info,
                                          const std::vector<Block>& blocks, const Sampling& sampling) {
  std::vector<std::vector<Sides>> all;
  for (const Block& block : blocks) all.push_back(sides_of(info, block, sampling));
  return all;
}

constexpr double kAllBlocks = -2.0;

/// @return nullopt if no other axes follow the poses clearly better
std::optional<AccelerometerAxes> best_axes(const std::vector<std::vector<Sides>>& blocks) {
  AccelerometerAxes found{.stated = sums_of(blocks, Eigen::Matrix3d::Identity(), kAllBlocks).correlation()};
  for (const Eigen::Matrix3d& P : datasets::axis_permutations()) {
    const double correlation = sums_of(blocks, P, kAllBlocks).correlation();
    if (correlation <= found.correlation) continue;
    found.correlation = correlation;
    found.P = P;
  }
  if (found.correlation < kMinCorrelation || found.stated > found.correlation - kBetter) return std::nullopt;
  return found;
}

/// Whether the gyroscope follows the ground truth much better with these axes.
bool gyroscope_has(const Eigen::Matrix3d& P, const datasets::SequenceInfo& info) {
  constexpr double kBetterResidual = 0.6;
  const std::vector<datasets::RatePair> pairs =
      rate_pairs(datasets::RateIntegral(info.imu),
                 rates_between(datasets::RateIntegral(info.ground_truth.trajectory), info.frame_times),
                 info.rig.time_offset_s);
  const Eigen::Matrix3d R_b_f = (info.rig.T_b_c * info.ground_truth.T_c_f).R();
  return relative_residual(pairs, P.transpose() * R_b_f) < kBetterResidual * relative_residual(pairs, R_b_f);
}

/// By the ground truth, which resolves a vibration that images do not. Half a period of one later, the stated
/// axes look inverted.
std::optional<AccelerometerAxes> axes_by_truth(const datasets::SequenceInfo& info) {
  const std::vector<Block> blocks = true_blocks(info);
  const Sampling stated{kShortInterval_s, info.rig.time_offset_s};
  auto found = best_axes(all_sides(info, blocks, stated));
  if (!found) return std::nullopt;
  for (double lag_s = -kMostLag_s; lag_s <= kMostLag_s; lag_s += kLagStepOfAxes_s) {
    const auto sides = all_sides(info, blocks, {kShortInterval_s, stated.offset_s + lag_s});
    const double late = sums_of(sides, Eigen::Matrix3d::Identity(), kAllBlocks).correlation();
    if (late > found->correlation - kBetter) return std::nullopt;
  }
  found->by_truth = true;
  found->gyroscope_too = gyroscope_has(found->P, info);
  return found;
}

}  // namespace

std::optional<AccelerometerAxes> accelerometer_axes(const datasets::SequenceInfo& info,
                                                    const RecordingSurvey& survey) {
  const Sampling sampling{kInterval_s, info.rig.time_offset_s};
  const auto found = best_axes(all_sides(info, blocks_of(survey), sampling));
  return found ? found : axes_by_truth(info);
}

std::optional<double> upward_part_of_force(const datasets::SequenceInfo& info) {
  constexpr double kSteady = 0.8;  // of the mean to the mean of the norms
  constexpr double kMostInterval_s = 0.1;
  const std::vector<StampedPose>& poses = info.ground_truth.trajectory.poses;
  const Eigen::Quaterniond q_f_b = (info.rig.T_b_c * info.ground_truth.T_c_f).q.conjugate();
  Eigen::Vector3d sum_w = Eigen::Vector3d::Zero();
  double norms = 0.0;
  for (const ImuSample& sample : info.imu) {
    const Timestamp t = after(sample.t, -info.rig.time_offset_s);
    const auto pose = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
    if (pose == poses.end() || seconds_between(t, pose->t) > kMostInterval_s) continue;
    sum_w += pose->T_w_f.q * (q_f_b * sample.accel_b);
    norms += sample.accel_b.norm();
  }
  if (norms <= 0.0 || sum_w.norm() < kSteady * norms) return std::nullopt;
  return sum_w.z() / sum_w.norm();
}

std::optional<InertialScale> inertial_depth_scale(const datasets::SequenceInfo& info,
                                                  const RecordingSurvey& survey) {
  std::vector<Sums> blocks;
  Sums all;
  for (const std::vector<Sides>& block :
       all_sides(info, blocks_of(survey), {kInterval_s, info.rig.time_offset_s})) {
    const Sums sums = sums_of({block}, Eigen::Matrix3d::Identity(), kFollows);
    if (sums.images <= 0.0) continue;
    blocks.push_back(sums);
    all.images += sums.images;
    all.both += sums.both;
  }
  if (blocks.size() < kLeastBlocks) return std::nullopt;
  InertialScale result{.scale = all.both / all.images};
  double squares = 0.0;  // of the errors, weighted by the motion of the block
  for (const Sums& sums : blocks) squares += std::pow(sums.both - result.scale * sums.images, 2);
  result.sigma = std::sqrt(squares) / all.images;
  return result;
}

}  // namespace stillpoint::bench
