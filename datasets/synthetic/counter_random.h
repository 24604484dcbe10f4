// SPDX-License-Identifier: BSD-3-Clause
/// Counter-based random numbers: a function of key and counter only, independent of threads and call order.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/content_hash.h"

namespace stillpoint::synth {

/// Independent random streams; draws of one stream do not affect the others. The values are part of the keys.
enum class RandomStream : std::uint64_t {
  kColorNoise = 1,
  kDepthNoise,
  kDroppedFrames,
  kGyro,
  kAccel,
  kMotion,
  kTexture,
  kScene,
  kPeople,
  kDetector,
  kFaults,
  kGrayNoise,
};

/// Key of one stream of one seed; `index` selects a substream (a frame, a person, a texture).
[[nodiscard]] constexpr std::uint64_t random_key(std::uint64_t seed, RandomStream stream,
                                                 std::uint64_t index = 0) {
  return mix_bits(mix_bits(seed ^ (static_cast<std::uint64_t>(stream) << 56)) + index);
}

/// Number of equal-probability cells of the standard normal distribution.
inline constexpr int kNormalQuantiles = 4096;

/// The quantiles at the centers of the cells, scaled to unit variance.
[[nodiscard]] const std::array<float, kNormalQuantiles>& normal_quantiles();

/// Standard normal deviate from the low 12 bits: the quantile at the center of one of 4096 equal-probability
/// cells. The tails are cut at 3.7 sigma.
[[nodiscard]] float normal_from_bits(std::uint64_t bits);

/// A sequence of numbers for scene building and sensors with few draws.
class RandomSequence {
 public:
  explicit RandomSequence(std::uint64_t key) : key_(key) {}

  [[nodiscard]] std::uint64_t bits() { return mix_bits(key_ + counter_++ * 0xd1342543de82ef95ULL); }
  /// In [0, 1).
  [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count).
  [[nodiscard]] int index(int count) { return static_cast<int>(uniform() * count); }
  /// Zero mean, unit variance (Box and Muller 1958).
  [[nodiscard]] double normal();
  [[nodiscard]] bool chance(double probability) { return uniform() < probability; }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace stillpoint::synth
