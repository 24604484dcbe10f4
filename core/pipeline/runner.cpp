// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runner.h"

#include "core/base/error.h"
#include "core/pipeline/odometry.h"

namespace stillpoint {
namespace {

/// Samples up to this long after an exposure are handed over before it: the cut at the exposure is
/// interpolated, and the time offset may grow.
constexpr double kImuLead_s = 0.02;

/// Hands the odometry the samples that a picture needs.
class ImuFeed {
 public:
  ImuFeed(std::span<const ImuSample> samples, double time_offset_s)
      : samples_(samples), offset_s_(time_offset_s) {}

  void up_to(Timestamp picture, Odometry& odometry) {
    const Timestamp end = after(picture, offset_s_ + kImuLead_s);
    for (; next_ < samples_.size() && samples_[next_].t <= end; ++next_) odometry.add_imu(samples_[next_]);
  }

 private:
  std::span<const ImuSample> samples_;
  double offset_s_;
  std::size_t next_ = 0;
};

/// The picture, or nothing and the reason in `summary`.
std::optional<Frame> load(const SensorInput& input, std::size_t index, ModuleTimings& timings,
                          RunSummary& summary) {
  const ScopedTimer timer(timings, Module::kImageDecoding);
  try {
    return input.load_frame(index);
  } catch (const InputError& error) {
    summary.skipped.push_back({index, error.what()});
    return std::nullopt;
  }
}

}  // namespace

RunSummary run_sequential(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  Odometry odometry(config, input.rig);
  ImuFeed imu(input.imu, input.rig.time_offset_s);
  RunSummary summary;
  for (std::size_t i = 0; i < input.frame_times.size(); ++i) {
    if (control.stop_requested && control.stop_requested()) {
      summary.interrupted = true;
      break;
    }
    ++summary.frames;
    ModuleTimings decoding;
    const std::optional<Frame> frame = load(input, i, decoding, summary);
    if (!frame) continue;
    imu.up_to(frame->t, odometry);
    OdometryUpdate update = odometry.process(*frame);
    update.timings.add(decoding);
    summary.resets += update.counters.reset;
    control.on_update(update);
  }
  summary.imu_health = odometry.imu_health();
  if (summary.frames > 0 && summary.skipped.size() == summary.frames) {
    throw InputError("no picture of the sequence could be read; the first: " +
                     summary.skipped.front().reason);
  }
  return summary;
}

}  // namespace stillpoint
