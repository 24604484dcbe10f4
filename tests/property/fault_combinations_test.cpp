// SPDX-License-Identifier: BSD-3-Clause
// Random combinations of faults on short simulated runs: no exception, no pose that is not finite. The number
// of runs and the first seed are those of the environment, see scripts/fault_combinations.sh.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <string>

#include "tests/support/published_config.h"
#include "tests/support/random.h"
#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

constexpr double kSeconds = 2.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

int environment(const char* name, int value) {
  const char* text = std::getenv(name);
  return text == nullptr ? value : std::stoi(text);
}

/// A fault that is active during a random part of the run.
struct Window {
  double begin = 0.0;
  double end = 0.0;
  double amount = 0.0;

  explicit Window(Random& random) : begin(random.uniform(0.0, kSeconds)) {
    end = begin + random.uniform(0.0, 1.0);
    amount = random.uniform(0.0, 1.0);
  }
  [[nodiscard]] bool contains(Timestamp t) const { return to_seconds(t) >= begin && to_seconds(t) < end; }
};

using FrameChange = std::function<void(TrackedFrame&)>;
using ImuChange = std::function<void(std::vector<ImuSample>&)>;

void change_feature(int kind, double amount, TrackedFeature& feature) {
  if (kind == 1) feature.id += 1000 * (1 + static_cast<std::int64_t>(10.0 * amount));
  if (kind == 2) feature.depth = 0.0;
  if (kind == 3) feature.depth *= 0.2 + 4.0 * amount;
  if (kind == 4) feature.bearing.x() = kNaN;
  if (kind == 5) feature.bearing += Eigen::Vector2d::Constant(amount);
  if (kind == 6) feature.bearing = Eigen::Vector2d::Zero();
  if (kind == 7) feature.depth = kNaN;
}

FrameChange random_frame_change(Random& random) {
  const Window window(random);
  const int kind = static_cast<int>(random.uniform(0.0, 9.0));
  return [=](TrackedFrame& frame) {
    if (!window.contains(frame.t)) return;
    if (kind == 0) frame.features.clear();
    if (kind == 8)
      std::erase_if(frame.features,
                    [&](const auto& f) { return static_cast<double>(f.id % 10) < 10.0 * window.amount; });
    for (TrackedFeature& feature : frame.features) change_feature(kind, window.amount, feature);
  };
}

void change_sample(int kind, double amount, ImuSample& sample) {
  if (kind == 1) sample.accel_b.x() += 100.0 * amount;
  if (kind == 2) sample.gyro_b.y() += 10.0 * amount;
  if (kind == 3) sample.accel_b = sample.accel_b.cwiseMax(-9.0).cwiseMin(9.0);
  if (kind == 4) sample.accel_b.z() = 1e300;
  if (kind == 5) sample.gyro_b.z() = kNaN;
  if (kind == 6) sample.t = after(sample.t, 2.0 * amount - 1.0);
  if (kind == 7) sample.gyro_b.x() = 1e200;
  if (kind == 8) sample.accel_b.setZero();
}

ImuChange random_imu_change(Random& random) {
  const Window window(random);
  const int kind = static_cast<int>(random.uniform(0.0, 9.0));
  return [=](std::vector<ImuSample>& samples) {
    if (kind == 0) {
      std::erase_if(samples, [&](const ImuSample& sample) { return window.contains(sample.t); });
    }
    for (ImuSample& sample : samples) {
      if (window.contains(sample.t)) change_sample(kind, window.amount, sample);
    }
  };
}

FaultyScenario random_scenario(int seed) {
  Random random(static_cast<std::uint32_t>(seed));
  FaultyScenario scenario;
  scenario.seconds = kSeconds;
  scenario.motion.points = 80;
  scenario.uses_imu = random.uniform(0.0, 1.0) < 0.75;
  if (seed % 4 != 0) use_consistent_prior(scenario.backend);
  if (random.uniform(0.0, 1.0) < 0.25) {
    scenario.backend = published_config().backend;
    scenario.backend.rate_hz = 0.0;
  }
  scenario.backend.window_size = 5;
  scenario.backend.bias_steps = seed % 2 == 0;
  scenario.backend.max_dead_reckoning_s = random.uniform(0.0, 1.0);
  scenario.backend.max_relocalization_s = random.uniform(0.0, 0.5);
  std::vector<FrameChange> frames;
  std::vector<ImuChange> samples;
  for (int i = 0; i < 3; ++i) {
    if (random.uniform(0.0, 1.0) < 0.6) frames.push_back(random_frame_change(random));
    if (random.uniform(0.0, 1.0) < 0.6) samples.push_back(random_imu_change(random));
  }
  scenario.change_frame = [frames](TrackedFrame& frame) {
    for (const FrameChange& change : frames) change(frame);
    std::ranges::sort(frame.features, {}, &TrackedFeature::id);
  };
  scenario.change_imu = [samples](std::vector<ImuSample>& imu) {
    for (const ImuChange& change : samples) change(imu);
  };
  return scenario;
}

TEST(FaultCombinations, NeverGiveAPoseThatIsNotFinite) {
  const int first = environment("STILLPOINT_FAULT_SEED", 1);
  const int runs = environment("STILLPOINT_FAULT_RUNS", 60);
  for (int seed = first; seed < first + runs; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const FaultyRun run = run_with_faults(random_scenario(seed));
    for (const FaultyFrame& frame : run.frames) {
      const NavState& state = frame.update.state;
      ASSERT_TRUE(state.T_w_b.p.allFinite() && state.T_w_b.q.coeffs().allFinite() && state.v_w.allFinite())
          << status_name(frame.update.status) << " at " << frame.t << " s";
      ASSERT_NEAR(state.T_w_b.q.norm(), 1.0, 1e-6);
    }
  }
}

}  // namespace
}  // namespace stillpoint
