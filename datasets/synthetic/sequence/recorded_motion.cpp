// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/recorded_motion.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.h"
#include "datasets/io/imu_file.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::synth {
namespace {

Pose euroc_T_b_c() {  // mav0/cam0/sensor.yaml of the EuRoC data set (Burri et al. 2016)
  Eigen::Matrix4d T_b_c;
  T_b_c << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975, 0.999557249008,
      0.0149672133247, 0.025715529948, -0.064676986768, -0.0257744366974, 0.00375618835797, 0.999660727178,
      0.00981073058949, 0.0, 0.0, 0.0, 1.0;
  return Pose::from_matrix(T_b_c);
}

Pose level_T_b_c() {
  Eigen::Matrix4d T_b_c;  // x right = -x, y down = -z, z forward = -y of the IMU
  T_b_c << -1.0, 0.0, 0.0, 0.05, 0.0, 0.0, -1.0, -0.07, 0.0, -1.0, 0.0, -0.04, 0.0, 0.0, 0.0, 1.0;
  return Pose::from_matrix(T_b_c);
}

template <class Stamped>
std::vector<Stamped> between(const std::vector<Stamped>& all, Timestamp from, Timestamp to) {
  std::vector<Stamped> part;
  std::copy_if(all.begin(), all.end(), std::back_inserter(part),
               [&](const Stamped& one) { return one.t >= from && one.t <= to; });
  return part;
}

ImuRecord to_imu_record(const std::vector<ImuSample>& samples) {
  ImuRecord record;
  for (const ImuSample& sample : samples) {
    record.gyro.push_back({sample.t, sample.gyro_b});
    record.accel.push_back({sample.t, sample.accel_b});
  }
  return record;
}

Eigen::Vector3d mean_force(const std::vector<ImuSample>& samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) sum += sample.accel_b;
  return sum / static_cast<double>(samples.size());
}

}  // namespace

Pose virtual_camera_T_b_c(const Eigen::Vector3d& up_b) {
  const Eigen::Vector3d up = up_b.normalized();
  constexpr double kWithin45Degrees = 0.7071;
  if (up.x() > kWithin45Degrees) return euroc_T_b_c();
  if (up.z() > kWithin45Degrees) return level_T_b_c();
  throw InputError(
      "--imu", fmt::format("the mean specific force points along ({:.2f}, {:.2f}, {:.2f}); expected an IMU "
                           "whose x or z axis points up",
                           up.x(), up.y(), up.z()));
}

RecordedMotion load_recorded_motion(const SynthRequest& request) {
  FaultLog faults;
  const Trajectory truth = eval::read_tum_ground_truth(request.trajectory_file, "imu", faults).trajectory;
  const std::vector<ImuSample> imu =
      datasets::read_imu_file(request.imu_file, eval::TimeUnit::kNanoseconds, faults);
  const Timestamp common = std::max(truth.poses.front().t, imu.front().t);
  const Timestamp epoch = after(common, std::max(request.start_s, kRecordingMargin_s));
  const Timestamp from = after(epoch, -kRecordingMargin_s),
                  to = after(epoch, request.seconds + kRecordingMargin_s);
  if (std::min(truth.poses.back().t, imu.back().t) < to) {
    throw InputError(
        request.trajectory_file.string(),
        fmt::format(
            "trajectory and IMU samples overlap for {:.1f} s, but {:.1f} s from {:.1f} s on are required; "
            "reduce --seconds or --start",
            seconds_between(common, std::min(truth.poses.back().t, imu.back().t)), request.seconds,
            request.start_s));
  }
  const std::vector<StampedPose> poses = between(truth.poses, from, to);
  const std::vector<ImuSample> readings = between(imu, from, to);
  return {smooth_motion({poses, readings, epoch, -kRecordingMargin_s, request.seconds + kRecordingMargin_s}),
          epoch, to_imu_record(readings), virtual_camera_T_b_c(mean_force(readings))};
}

}  // namespace stillpoint::synth
