// SPDX-License-Identifier: BSD-3-Clause
/// Cost of taking one frame out of a full inertial window.
#include <benchmark/benchmark.h>

#include "bench/micro/flown_window.h"
#include "core/backend/marginalization.h"

namespace stillpoint {
namespace {

void marginalize_oldest_frame(benchmark::State& state) {
  const Window window = flown_window();
  const BackendConfig config = flown_config();
  for (auto _ : state) benchmark::DoNotOptimize(marginalize_oldest(window, config, kFlownFocal_px));
}
BENCHMARK(marginalize_oldest_frame)->Unit(benchmark::kMillisecond);

void marginalize_second_newest_frame(benchmark::State& state) {
  const Window window = flown_window();
  const LinearPrior prior = marginalize_oldest(window, flown_config(), kFlownFocal_px);
  const int newest = prior.blocks.back().frame;
  for (auto _ : state) benchmark::DoNotOptimize(marginalize_frame(prior, newest));
}
BENCHMARK(marginalize_second_newest_frame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillpoint
