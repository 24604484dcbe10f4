// SPDX-License-Identifier: BSD-3-Clause
/// Random stores with planted effects: what statistics may say about them is known.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

inline constexpr const char* kChangedVariant = "changed";
inline constexpr std::size_t kSmallestCount = 6;  ///< 2^(1-n) <= 0.05
inline constexpr double kLargeEffect = 1.5;       ///< of the error: a factor of this or its inverse

/// Ranges of a random store.
struct PlantedRanges {
  int replicates = 30;  ///< at most, of each variant on each sequence
  int sequences = 2;
  int builds = 3;
};

struct PlantedStore {
  std::string base;             ///< of the ablation: the other variant is `kChangedVariant`
  double variant_effect = 1.0;  ///< factor of the error of the other variant, 1 = none
  double build_effect = 1.0;    ///< factor of the error of the newest build relative to the one before
  std::vector<std::string> builds;
  std::map<std::string, double> medians;  ///< of the error of `base` with the newest build, by sequence
  std::vector<StoredRun> runs;            ///< in the order of their start, build by build
};

/// Runs of one build.
inline std::vector<StoredRun> runs_with(const PlantedStore& store, const std::string& build) {
  std::vector<StoredRun> runs = store.runs;
  std::erase_if(runs, [&](const StoredRun& run) { return run.identity.build != build; });
  return runs;
}

/// Successful runs of a variant on a sequence.
inline std::size_t succeeded(const std::vector<StoredRun>& runs, const std::string& variant,
                             const std::string& sequence) {
  return static_cast<std::size_t>(std::count_if(runs.begin(), runs.end(), [&](const StoredRun& run) {
    return run.outcome == Outcome::kOk && run.identity.variant == variant &&
           run.identity.sequence == sequence;
  }));
}

/// Number of values of the row of an ablation over all sequences: pairs of both variants, i.e. seeds with a
/// successful run of each, or sequences with such a pair if there are several.
inline std::size_t paired_values(const std::vector<StoredRun>& runs, const std::string& base) {
  std::map<std::pair<std::string, std::int64_t>, std::pair<bool, bool>> found;
  for (const StoredRun& run : runs) {
    auto& [has_base, has_other] = found[{run.identity.sequence, run.identity.seed}];
    if (run.outcome == Outcome::kOk) (run.identity.variant == base ? has_base : has_other) = true;
  }
  std::map<std::string, std::size_t> pairs;
  for (const auto& [subject, has] : found) {
    if (has.first && has.second) ++pairs[subject.first];
  }
  return pairs.size() == 1 ? pairs.begin()->second : pairs.size();
}

/// Creates the runs of one store. The error of a run is
///
///   median of the sequence * effect of the variant * level of the build * exp(a) * exp(b)
///
/// with a normal for each sequence and replicate, and b normal for each run; without effects, runs of both
/// variants or both builds are exchangeable.
class StorePlanter {
 public:
  StorePlanter(unsigned seed, const PlantedRanges& ranges) : random_(seed), ranges_(ranges) {}

  [[nodiscard]] PlantedStore planted() {
    PlantedStore store;
    store.base = std::array{"stillpoint", "dynamic_vins", "vo"}[pick(3)];
    store.variant_effect = effect();
    store.build_effect = effect();
    replicates_ = 1 + static_cast<int>(pick(static_cast<std::size_t>(ranges_.replicates)));
    is_perturbed_ = pick(4) == 0;
    failure_rate_ = pick(2) == 0 ? 0.0 : 0.1;
    noise_ = std::array{0.02, 0.1, 0.3}[pick(3)];
    const std::size_t builds = 1 + pick(static_cast<std::size_t>(ranges_.builds));
    for (std::size_t i = 0; i < builds; ++i) store.builds.push_back(fmt::format("build{}", i));
    const std::size_t sequences = 1 + pick(static_cast<std::size_t>(ranges_.sequences));
    for (std::size_t i = 0; i < sequences; ++i)
      store.medians[fmt::format("seq{}", i)] = std::exp(normal()) * 0.01;
    for (std::size_t i = 0; i < builds; ++i) add_build(store, i);
    return store;
  }

 private:
  std::size_t pick(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }
  double normal() { return std::normal_distribution<double>()(random_); }
  double effect() { return std::array{1.0, kLargeEffect, 1.0 / kLargeEffect}[pick(3)]; }

  void add_build(PlantedStore& store, std::size_t index) {
    // Builds before the last two differ by factors that would distort any statistic that pools them.
    double level = index + 1 == store.builds.size() ? 1.0 : 1.0 / store.build_effect;
    if (index + 2 < store.builds.size()) level = 5.0;
    for (const std::string& variant : {store.base, std::string(kChangedVariant)}) {
      const double factor = variant == store.base ? level : level * store.variant_effect;
      for (const auto& [sequence, median] : store.medians) {
        for (int i = 1; i <= replicates_; ++i) {
          store.runs.push_back(run_of(identity_of({variant, sequence, i}, store.builds[index]),
                                      median * factor * shared_level(sequence, i)));
          store.runs.back().id = static_cast<std::int64_t>(store.runs.size());
        }
      }
    }
  }

  struct Replicate {
    std::string variant;
    std::string sequence;
    int number;
  };

  [[nodiscard]] RunIdentity identity_of(const Replicate& replicate, const std::string& build) const {
    const auto number = static_cast<std::int64_t>(replicate.number);
    return {.variant = replicate.variant,
            .sequence = replicate.sequence,
            .sequence_id = "files of " + replicate.sequence,
            .config_hash = is_perturbed_
                               ? perturbed_hash("config of " + replicate.variant, replicate.number - 1)
                               : fmt::format("config of {} seed {}", replicate.variant, number),
            .build = build,
            .seed = is_perturbed_ ? 1 : number,
            .repetition = is_perturbed_ ? number : 1};
  }

  /// exp(a), equal in all builds and variants.
  double shared_level(const std::string& sequence, int replicate) {
    const auto [entry, is_new] = shared_.insert({{sequence, replicate}, 0.0});
    if (is_new) entry->second = std::exp(noise_ * normal());
    return entry->second;
  }

  StoredRun run_of(const RunIdentity& identity, double level) {
    StoredRun run;
    run.identity = identity;
    run.key = run_key(identity);
    if (std::uniform_real_distribution<double>()(random_) < failure_rate_) {
      run.outcome = Outcome::kCrashed;
      run.detail = "terminated by signal 11";
      return run;
    }
    run.metrics = {{"ate_rmse_m", "compat:tum", "m", level * std::exp(noise_ * normal())},
                   {"process_cpu_s", "", "s", 10.0 * std::exp(0.02 * normal())}};
    run.blobs = {{"trajectory", run.key}};
    return run;
  }

  std::mt19937_64 random_;
  PlantedRanges ranges_;
  int replicates_ = 1;
  bool is_perturbed_ = false;
  double failure_rate_ = 0.0;
  double noise_ = 0.1;
  std::map<std::pair<std::string, int>, double> shared_;
};

/// Statements that were made without cause, out of those that could have been.
struct FalseAlarms {
  int possible = 0;
  int made = 0;

  void add(bool is_made) {
    ++possible;
    made += is_made ? 1 : 0;
  }
  /// 99 % quantile of the binomial distribution, by its normal approximation and at least 3.
  [[nodiscard]] double limit(double rate) const {
    const double mean = rate * possible;
    return std::max(3.0, mean + 2.33 * std::sqrt(mean * (1.0 - rate)));
  }
};

/// -1, 0 or 1.
inline int sign_of(double value) { return value > 0.0 ? 1 : (value < 0.0 ? -1 : 0); }

}  // namespace stillpoint::bench
