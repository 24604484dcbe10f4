// SPDX-License-Identifier: BSD-3-Clause
// False alarms, inconclusive results and power of comparisons by the number of runs, by simulation. Prints
// the table of bench/README.md.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/analysis/comparison.h"
#include "bench/analysis/search/bisection.h"
#include "tests/support/compared_runs.h"

namespace stillpoint::bench {
namespace {

constexpr std::array<int, 6> kCounts = {1, 6, 8, 13, 20, 40};
constexpr std::array<double, 4> kEffects = {0.0, 0.03, 0.1, 0.3};

using Random = std::mt19937_64;

double normal_factor(Random& random, double sigma) {
  return std::exp(std::normal_distribution<double>(0.0, sigma)(random));
}

/// How runs of one program scatter.
struct NoiseModel {
  std::string name;
  std::string kind = "accuracy";
  bool seeds = false;  ///< replicates are seeds of the scene, paired; else perturbations of one scene
  int sequences = 3;
  std::function<double(Random&)> factor;
};

const std::vector<NoiseModel>& noise_models() {
  static const std::vector<NoiseModel> models = {
      {"deterministic, seeds of scenes", "accuracy", true, 8, [](Random&) { return 1.0; }},
      {"perturbed, 5 %", "accuracy", false, 3, [](Random& random) { return normal_factor(random, 0.05); }},
      {"perturbed, two modes (factor 2, 1 of 3)", "accuracy", false, 3,
       [](Random& random) { return (random() % 3 == 0 ? 2.0 : 1.0) * normal_factor(random, 0.02); }},
      {"time, 3 %", "timing", false, 3, [](Random& random) { return normal_factor(random, 0.03); }}};
  return models;
}

/// A comparison of `count` runs per side on each sequence, of which head has an error or time that is larger.
Comparison simulated(const NoiseModel& model, int count, double effect, Random& random) {
  std::vector<StoredRun> base;
  std::vector<StoredRun> head;
  for (int sequence = 0; sequence < model.sequences; ++sequence) {
    for (int i = 1; i <= count; ++i) {
      const double scene = model.seeds ? normal_factor(random, 0.5) : 1.0;
      for (std::vector<StoredRun>* side : {&base, &head}) {
        StoredRun run = compared_run(fmt::format("s{}", sequence), 0.01, i, side == &base ? "base" : "head");
        run.identity.kind = model.kind;
        if (model.seeds) {
          run.identity.seed = i;
          run.identity.repetition = 1;
          run.identity.config_hash = "config";
          run.identity.sequence_id += fmt::format(" {}", i);
        }
        // Base is not exactly equal: another rounding of the same program.
        const double level = scene * (side == &head ? 1.0 + effect : 1.0) * normal_factor(random, 1e-4);
        const bool is_timing = model.kind == "timing";
        run.metrics = {{"ate_rmse_m", "", "m", is_timing ? 0.01 : 0.01 * level * model.factor(random)},
                       {"process_cpu_s", "", "s", is_timing ? 10.0 * level * model.factor(random) : 10.0}};
        run.blobs["trajectory"] = is_timing ? "equal" : std::to_string(random());
        side->push_back(run);
      }
    }
  }
  return compare_runs(base, head);
}

struct Rates {
  double worse = 0.0;
  double inconclusive = 0.0;
  double false_alarms = 0.0;  ///< better or worse
};

Rates rates_of(const NoiseModel& model, int count, double effect, int comparisons) {
  Random random(static_cast<unsigned>(count) + 1000U);
  Rates rates;
  for (int i = 0; i < comparisons; ++i) {
    const ChangeClass result = simulated(model, count, effect, random).result();
    rates.worse += result == ChangeClass::kWorse ? 1.0 / comparisons : 0.0;
    rates.inconclusive += result == ChangeClass::kInconclusive ? 1.0 / comparisons : 0.0;
    rates.false_alarms +=
        result == ChangeClass::kWorse || result == ChangeClass::kBetter ? 1.0 / comparisons : 0.0;
  }
  return rates;
}

/// Equal programs of which each run has a value with heavy tails, two modes, or a drift over time.
TEST(ComparisonPower, EqualProgramsAreCalledDifferentInAtMost5PercentWhateverTheNoise) {
  int runs = 0;
  const std::vector<NoiseModel> models = {
      {"heavy tails", "accuracy", false, 3,
       [](Random& random) { return std::exp(0.1 * std::cauchy_distribution<double>()(random)); }},
      {"two modes", "accuracy", true, 3,
       [](Random& random) { return (random() % 2 == 0 ? 3.0 : 1.0) * normal_factor(random, 0.05); }},
      {"drift of times", "timing", false, 3,
       [&](Random& random) { return (1.0 + 1e-4 * (runs++ % 3000)) * normal_factor(random, 0.03); }}};
  for (const NoiseModel& model : models) {
    constexpr int kComparisons = 1000;
    const double alarms = kComparisons * rates_of(model, 8, 0.0, kComparisons).false_alarms;
    std::cout << model.name << ": " << alarms << " false alarms in " << kComparisons << '\n';
    EXPECT_LE(alarms, 0.05 * kComparisons) << model.name;
  }
}

/// In how many of 200 searches for a change between equal programs one is followed, as `bisect` does: with
/// the first 8, 16 and 32 pairs.
int followed_searches(std::size_t looks) {
  Random random(1);
  const NoiseModel model{"perturbed, 20 %", "accuracy", false, 1,
                         [](Random& same) { return normal_factor(same, 0.2); }};
  int followed = 0;
  for (int search = 0; search < 200; ++search) {
    std::vector<StoredRun> base, head;
    for (int i = 1; i <= 32; ++i) {
      base.push_back(compared_run("a", model.factor(random), i));
      head.push_back(compared_run("a", model.factor(random), i, "head"));
    }
    bool is_followed = false;
    for (const std::size_t pairs : {8u, 16u, 32u}) {
      const Comparison comparison =
          compare_runs(std::span(base).first(pairs), std::span(head).first(pairs), CompareSource::kPrograms);
      is_followed = is_followed || followed_change(comparison, "ate_rmse_m", looks);
    }
    followed += is_followed ? 1 : 0;
  }
  return followed;
}

TEST(ComparisonPower, ASearchFollowsAChangeOfEqualProgramsRarelyHoweverManyComparisonsItMakes) {
  EXPECT_LE(followed_searches(3), 10);
  EXPECT_GT(followed_searches(1), 14) << "the correction is needed";
}

TEST(ComparisonPower, TenPercentOfTimeWith3PercentNoiseAreFoundWithTenPairs) {
  EXPECT_GE(rates_of(noise_models().back(), 10, 0.1, 300).worse, 0.95);
}

TEST(ComparisonPower, ADeterministicChangeIsFoundWithOnePairPerSequenceFromSixSequencesOn) {
  NoiseModel model = noise_models().front();
  model.sequences = 6;
  EXPECT_NEAR(rates_of(model, 1, 0.1, 50).worse, 1.0, 1e-9);
}

TEST(ComparisonPower, FalseAlarmsAreRareAndPowerGrowsWithTheNumberOfRuns) {
  constexpr double kTolerance = 0.12;  // 3 standard deviations of a rate of 100 comparisons, at most
  std::cout << "| noise | n | inconclusive without change | +3 % | +10 % | +30 % "
               "|\n|---|---:|---:|---:|---:|---:|\n";
  for (const NoiseModel& model : noise_models()) {
    double last_inconclusive = 1.0;
    std::array<double, kEffects.size()> last_power{};
    for (const int count : kCounts) {
      const int comparisons = count == 40 ? 40 : 100;
      std::string row;
      for (std::size_t k = 0; k < kEffects.size(); ++k) {
        const Rates rates = rates_of(model, count, kEffects[k], comparisons);
        if (k == 0) {
          row += fmt::format("{:.0f} % |", 100.0 * rates.inconclusive);
          EXPECT_LE(rates.false_alarms, 0.05 + kTolerance) << model.name << ' ' << count;
          if (count >= 6) {
            EXPECT_LE(rates.inconclusive, last_inconclusive + kTolerance) << model.name << ' ' << count;
            last_inconclusive = rates.inconclusive;
          }
          continue;
        }
        row += fmt::format(" {:.0f} % |", 100.0 * rates.worse);
        if (kEffects[k] < 0.05) continue;  // below the margin: the estimate exceeds it by chance
        EXPECT_GE(rates.worse, last_power[k] - kTolerance) << model.name << ' ' << count;
        last_power[k] = rates.worse;
      }
      std::cout << fmt::format("| {} | {} | {}\n", model.name, count, row) << std::flush;
    }
  }
}

}  // namespace
}  // namespace stillpoint::bench
