// SPDX-License-Identifier: BSD-3-Clause
// Faults, recovery and wrong calibration with the shipped default, on simulated motion: rates over
// seeds, which change the noise of all sensors and the fault.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "bench/config/config_file.h"
#include "core/geometry/covariance.h"
#include "core/geometry/so3.h"
#include "core/pipeline/stages/optimization_stage.h"
#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

constexpr std::uint32_t kSeeds = 12;
constexpr double kFault_s = 3.0;
constexpr double kRun_s = 6.0;
constexpr double kRecovered_s = 5.5;      ///< faults that end have ended 1 s ago
constexpr double kMaxError_m = 0.05;      ///< of a located frame that does not claim as much
constexpr double kMaxRemaining_m = 0.03;  ///< from kRecovered_s on, when all frames are located
/// Of one case: a rate of 5 % gives more with a probability of 0.2 %.
constexpr int kMaxFailures = 3;

/// P(at most k failures of n) with the rate p.
double binomial_cdf(int k, int n, double p) {
  double sum = 0.0;
  for (int i = 0; i <= k; ++i) {
    const double log_ways = std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0);
    sum += std::exp(log_ways + i * std::log(p) + (n - i) * std::log1p(-p));
  }
  return sum;
}

/// Upper end of the one-sided 95 % interval of a rate, k failures of n (Clopper and Pearson 1934).
double upper_bound_of_rate(int k, int n) {
  double low = static_cast<double>(k) / n, high = 1.0;
  while (high - low > 1e-6) {
    const double p = 0.5 * (low + high);
    (binomial_cdf(k, n, p) > 0.05 ? low : high) = p;
  }
  return high;
}

/// What a seed makes wrong.
struct ShippedCase {
  const char* name;
  std::function<void(Random&, FaultyScenario&)> fault = [](Random&, FaultyScenario&) {};
  std::function<void(Random&, Rig&)> calibration_error = [](Random&, Rig&) {};
};

Eigen::Vector3d random_direction(Random& random) { return random.normal3().normalized(); }

template <class Change>
std::function<void(std::vector<ImuSample>&)> changed_from_fault_on(const Change& change) {
  return [=](std::vector<ImuSample>& samples) {
    for (ImuSample& sample : samples) {
      if (to_seconds(sample.t) >= kFault_s) change(sample);
    }
  };
}

/// For 1.5 s, a person without a box covers `fraction` of the features: new ones at a depth of 0.6 m, which
/// move with the person.
std::function<void(TrackedFrame&)> covering_person(double fraction, Random& random) {
  const double sideways = random.uniform(-0.4, 0.4);
  const double phase = random.uniform(0.0, 6.0);
  return [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t) - kFault_s;
    if (t < 0.0 || t >= 1.5) return;
    const Camera camera = SimulatedMotion::rig().camera;
    for (TrackedFeature& feature : frame.features) {
      if (static_cast<double>(feature.id % 10) >= 10.0 * fraction) continue;
      const double row = static_cast<double>(feature.id % 17) / 17.0 - 0.5;
      const double column = static_cast<double>(feature.id % 13) / 13.0 - 0.5;
      feature.depth = 0.6 + 0.1 * column;
      feature.bearing = {column + sideways * t + 0.1 * std::sin(2.0 * t + phase),
                         0.8 * row + 0.05 * std::sin(5.0 * t + phase)};
      feature.pixel = camera.project(feature.bearing.homogeneous());
      feature.id += 100000;
    }
    std::ranges::sort(frame.features, {}, &TrackedFeature::id);
  };
}

/// For 1.5 s.
std::function<void(TrackedFrame&)> scaled_depth(double factor) {
  return [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t) - kFault_s;
    if (t < 0.0 || t >= 1.5) return;
    for (TrackedFeature& feature : frame.features) feature.depth *= factor;
  };
}

std::vector<ShippedCase> inertial_faults() {
  return {
      {"shock",
       [](Random& random, FaultyScenario& scenario) {
         const Eigen::Vector3d direction = random_direction(random);
         const double force = random.uniform(6.0, 20.0);
         scenario.change_imu = shock(kFault_s, kFault_s + 0.5, force * direction);
       }},
      {"gyro_step",
       [](Random& random, FaultyScenario& scenario) {
         const Eigen::Vector3d direction = random_direction(random);
         const Eigen::Vector3d step = random.uniform(0.02, 0.3) * direction;
         scenario.change_imu = changed_from_fault_on([=](ImuSample& sample) { sample.gyro_b += step; });
       }},
      {"accel_step",
       [](Random& random, FaultyScenario& scenario) {
         const Eigen::Vector3d direction = random_direction(random);
         const Eigen::Vector3d step = random.uniform(0.3, 1.0) * direction;
         scenario.change_imu = changed_from_fault_on([=](ImuSample& sample) { sample.accel_b += step; });
       }},
      {"imu_gap",
       [](Random& random, FaultyScenario& scenario) {
         scenario.change_imu = imu_gap(kFault_s, kFault_s + random.uniform(0.1, 1.5));
       }},
      {"imu_late",
       [](Random& random, FaultyScenario& scenario) {
         scenario.motion.time_offset_s = random.uniform(-0.02, 0.02);
       }},
  };
}

std::vector<ShippedCase> visual_faults() {
  return {
      {"blank",
       [](Random& random, FaultyScenario& scenario) {
         const double seconds = random.uniform(0.1, 1.0);
         scenario.change_frame = blank(kFault_s, kFault_s + seconds, random.uniform(0.0, 1.0) < 0.5);
       }},
      {"person over half of the image",
       [](Random& random, FaultyScenario& scenario) {
         scenario.change_frame = covering_person(0.5, random);
       }},
      {"person over most of the image",
       [](Random& random, FaultyScenario& scenario) {
         scenario.change_frame = covering_person(0.8, random);
       }},
      {"depth_scaled",
       [](Random& random, FaultyScenario& scenario) {
         scenario.change_frame = scaled_depth(random.uniform(0.8, 0.9));
       }},
  };
}

std::vector<ShippedCase> calibration_errors() {
  const auto none = [](Random&, FaultyScenario&) {};
  return {
      {"focal_error", none,
       [](Random& random, Rig& rig) {
         const double factor = random.uniform(0.0, 1.0) < 0.5 ? 0.98 : 1.02;
         rig.camera.fx *= factor;
         rig.camera.fy *= factor;
       }},
      {"rotation_error", none,
       [](Random& random, Rig& rig) {
         rig.T_b_c.q = rig.T_b_c.q * exp_so3(2.0 / 180.0 * M_PI * random_direction(random));
       }},
      {"lever_error", none, [](Random& random, Rig& rig) { rig.T_b_c.p += 0.02 * random_direction(random); }},
  };
}

/// Whether the run survives the fault in the same world, and claims no pose that is wrong.
bool is_as_expected(const ShippedCase& tested, std::uint32_t seed) {
  Random random(seed);
  FaultyScenario scenario{
      .motion = {.pixel_noise_px = 0.3, .depth_noise = 0.003, .noisy_imu = true, .seed = seed},
      .seconds = kRun_s};
  tested.fault(random, scenario);
  Rig rig = rig_of(scenario);
  tested.calibration_error(random, rig);
  OptimizationStage stage(bench::load_config({}), rig);
  const FaultyRun run = run_with_faults(
      scenario, stage,
      [&](const TrackedFrame& frame) -> const OdometryUpdate& { return stage.process(frame, {}); });
  const auto is_false = [](const FaultyFrame& frame) {
    if (!is_located(frame.update.status) || frame.error_m <= kMaxError_m) return false;
    return !frame.update.covariance ||
           frame.error_m > 3.0 * largest_sigma(frame.update.covariance->position());
  };
  const auto is_off = [](const FaultyFrame& frame) {
    return !is_located(frame.update.status) || frame.error_m > kMaxRemaining_m;
  };
  return run.count(0.0, kEnd_s, is_false) == 0 && run.count(kRecovered_s, kEnd_s, is_off) == 0;
}

struct Rate {
  int failures = 0;
  int runs = 0;
};

Rate run_cases(const std::vector<ShippedCase>& cases) {
  Rate rate;
  for (const ShippedCase& tested : cases) {
    int failures = 0;
    for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) failures += is_as_expected(tested, seed) ? 0 : 1;
    EXPECT_LE(failures, kMaxFailures) << tested.name;
    rate.failures += failures;
    rate.runs += static_cast<int>(kSeeds);
  }
  return rate;
}

/// Over all cases, fewer than 5 % of the runs fail, with a confidence of 95 %.
TEST(ShippedConfig, SurvivesFaultsAndWrongCalibrationOverSeeds) {
  std::vector<ShippedCase> cases{{.name = "none"}};
  for (const auto& group : {inertial_faults(), visual_faults(), calibration_errors()})
    cases.insert(cases.end(), group.begin(), group.end());
  const Rate rate = run_cases(cases);
  EXPECT_LT(upper_bound_of_rate(rate.failures, rate.runs), 0.05) << rate.failures << " of " << rate.runs;
}

TEST(ShippedConfig, TheBoundOfARateIsThatOfClopperAndPearson) {
  EXPECT_NEAR(upper_bound_of_rate(0, 60), 1.0 - std::pow(0.05, 1.0 / 60.0), 1e-5);
  EXPECT_NEAR(upper_bound_of_rate(1, 10), 0.3942, 1e-4);  // table of the binomial distribution
}

}  // namespace
}  // namespace stillpoint
