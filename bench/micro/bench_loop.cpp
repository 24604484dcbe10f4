// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of loop closure: place recognition, one query among 5,000 places of 300 features, a third of
/// which are noisy copies of 1,000 patterns, as in repeated textures; and the pose graph of 10,000 keyframes
/// with 500 loops, of which a tenth is false.
#include <random>

#include <benchmark/benchmark.h>

#include "core/loop/place_recognition.h"
#include "tests/support/simulated/simulated_pose_graph.h"

namespace stillpoint {
namespace {

constexpr int kFeatures = 300;
constexpr int kPatterns = 1000;
constexpr int kFlippedBits = 20;

class FeatureSource {
 public:
  FeatureSource() {
    for (int i = 0; i < kPatterns; ++i) patterns_.push_back({random_(), random_(), random_(), random_()});
  }
  std::vector<KeyframeFeature> place() {
    std::vector<KeyframeFeature> features(kFeatures);
    for (int i = 0; i < kFeatures; ++i) {
      Descriptor& descriptor = features[static_cast<std::size_t>(i)].descriptor;
      descriptor = {random_(), random_(), random_(), random_()};
      if (i % 3 == 0) descriptor = noisy(patterns_[random_() % kPatterns]);
    }
    return features;
  }

 private:
  Descriptor noisy(Descriptor descriptor) {
    for (int i = 0; i < kFlippedBits; ++i) descriptor[random_() % 4] ^= std::uint64_t{1} << (random_() % 64);
    return descriptor;
  }

  std::mt19937_64 random_{1};
  std::vector<Descriptor> patterns_;
};

/// @param state range: places
void query_place(benchmark::State& state) {
  FeatureSource source;
  PlaceIndex index;
  for (std::int64_t place = 0; place < state.range(0); ++place) index.add(source.place());
  const std::vector<KeyframeFeature> query = source.place();
  for (auto _ : state) benchmark::DoNotOptimize(index.query(query));
}

BENCHMARK(query_place)->Arg(500)->Arg(5000)->Unit(benchmark::kMillisecond);

/// @param state ranges: keyframes, loops
void optimize_graph(benchmark::State& state) {
  const auto loops = static_cast<int>(state.range(1));
  const SimulatedPoseGraph simulated = simulated_pose_graph({.keyframes = static_cast<int>(state.range(0)),
                                                             .keyframes_per_lap = 500,
                                                             .loops = loops,
                                                             .false_every = 10,
                                                             .gravity = true});
  PoseGraphSolution solution;
  for (auto _ : state) solution = optimize_pose_graph(simulated.graph, {});
  for (std::size_t i = 0; i < solution.inliers.size(); ++i) {
    state.counters["accepted_false"] += solution.inliers[i] && !simulated.true_loops[i];
    state.counters["refused_true"] += !solution.inliers[i] && simulated.true_loops[i];
  }
  state.counters["error_m"] = largest_error_m(solution.T_m_b, simulated.truth);
}

BENCHMARK(optimize_graph)->Args({1000, 50})->Args({10000, 500})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
