// SPDX-License-Identifier: BSD-3-Clause
/// Metrics of the poses at IMU rate (`pipeline.imu_rate`), and those of the poses at frame rate that they are
/// compared with.
#pragma once

#include "bench/model/metrics.h"

namespace stillpoint::bench {

/// The value of one member of `ImuRateScore`; nullopt if poses at IMU rate were not recorded.
template <auto kMember>
[[nodiscard]] std::optional<double> imu_rate_value(const Measurements& m) {
  return m.imu_rate ? (*m.imu_rate).*kMember : std::nullopt;
}

inline constexpr MetricProtocol kShortRpeProtocol{
    "rpe_100ms", "strict: interval of 0.1 s within a tenth, interpolated ground truth"};

inline constexpr MetricDescriptor kImuRateMetrics[] = {
    {.id = "imu_rate_ate_rmse_m",
     .label = "ATE at IMU rate",
     .title = "Absolute trajectory error of the poses at IMU rate, RMSE",
     .description = "ATE of the poses at all IMU samples, as known when each sample arrived",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kImuRate,
     .value = imu_rate_value<&ImuRateScore::ate_m>},
    {.id = "imu_rate_rpe_100ms_rmse_m",
     .label = "T.RPE (0.1 s) at IMU rate",
     .title = "Translational relative pose error over 0.1 s of the poses at IMU rate, RMSE",
     .description = "Root mean square translation error over 0.1 s of the poses at IMU rate",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 5,
     .source = MetricSource::kImuRate,
     .protocol = kShortRpeProtocol,
     .value = imu_rate_value<&ImuRateScore::rpe_100ms_m>},
    {.id = "imu_rate_rpe_100ms_rmse_deg",
     .label = "R.RPE (0.1 s) at IMU rate",
     .title = "Rotational relative pose error over 0.1 s of the poses at IMU rate, RMSE",
     .description = "Root mean square rotation error over 0.1 s of the poses at IMU rate",
     .unit = "deg",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kImuRate,
     .protocol = kShortRpeProtocol,
     .value = imu_rate_value<&ImuRateScore::rpe_100ms_deg>},
    {.id = "imu_rate_rpe_trans_rmse_m_per_s",
     .label = "T.RPE at IMU rate",
     .title = "Translational relative pose error over 1 s of the poses at IMU rate, RMSE",
     .description = "Root mean square translation error over 1 s of the poses at IMU rate",
     .unit = "m/s",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kImuRate,
     .value = imu_rate_value<&ImuRateScore::rpe_m_per_s>},
    {.id = "imu_rate_rpe_rot_rmse_deg_per_s",
     .label = "R.RPE at IMU rate",
     .title = "Rotational relative pose error over 1 s of the poses at IMU rate, RMSE",
     .description = "Root mean square rotation error over 1 s of the poses at IMU rate",
     .unit = "deg/s",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kImuRate,
     .value = imu_rate_value<&ImuRateScore::rpe_deg_per_s>},
    {.id = "imu_rate_step_p95_m",
     .label = "step, 95 %",
     .title = "Translation of the poses at IMU rate when an estimate arrives, 95th percentile",
     .description = "Translation between the poses at one IMU sample by the old and by the new estimate",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 5,
     .source = MetricSource::kImuRate,
     .value = imu_rate_value<&ImuRateScore::step_p95_m>},
    {.id = "imu_rate_step_max_m",
     .label = "step, largest",
     .description = "Largest translation between the poses at one IMU sample by the old and the new estimate",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kImuRate,
     .value = imu_rate_value<&ImuRateScore::step_max_m>},
    {.id = "imu_rate_step_p95_deg",
     .label = "step, 95 %, rotation",
     .description = "Rotation between the poses at one IMU sample by the old and by the new estimate",
     .unit = "deg",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kImuRate,
     .value = imu_rate_value<&ImuRateScore::step_p95_deg>},
    {.id = "imu_rate_age_p95_ms",
     .label = "age, 95 %",
     .title = "Age of the estimate that poses at IMU rate are propagated from, 95th percentile",
     .description = "Time between the exposure of the newest frame in the estimate and the IMU sample; in "
                    "realtime mode it includes the latency of the estimate",
     .unit = "ms",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 1,
     .source = MetricSource::kImuRate,
     .value = imu_rate_value<&ImuRateScore::age_p95_ms>},
    {.id = "rpe_100ms_rmse_m",
     .label = "T.RPE (0.1 s)",
     .description = "Root mean square translation error over 0.1 s of the poses at frame rate",
     .unit = "m",
     .direction = MetricDirection::kSmallerIsBetter,
     .decimals = 5,
     .source = MetricSource::kImuRate,
     .protocol = kShortRpeProtocol,
     .value = imu_rate_value<&ImuRateScore::frame_rate_rpe_100ms_m>},
    {.id = "rpe_100ms_rmse_deg",
     .label = "R.RPE (0.1 s)",
     .description = "Root mean square rotation error over 0.1 s of the poses at frame rate",
     .unit = "deg",
     .direction = MetricDirection::kSmallerIsBetter,
     .source = MetricSource::kImuRate,
     .protocol = kShortRpeProtocol,
     .value = imu_rate_value<&ImuRateScore::frame_rate_rpe_100ms_deg>},
};

}  // namespace stillpoint::bench
