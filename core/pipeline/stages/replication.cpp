// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/replication.h"

#include <bit>

#include "core/base/content_hash.h"

namespace stillpoint {
namespace {

/// FNV-1a over 64-bit words instead of bytes.
class Fnv {
 public:
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3ULL; }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(std::int64_t number) { add(static_cast<std::uint64_t>(number)); }
  template <int Size>
  void add(const Eigen::Matrix<double, Size, 1>& vector) {
    for (int i = 0; i < Size; ++i) add(vector[i]);
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace

std::uint64_t state_hash(std::span<const TrackedFeature> features) {
  Fnv hash;
  for (const TrackedFeature& feature : features) {
    hash.add(feature.id);
    hash.add(feature.pixel);
    hash.add(feature.depth);
  }
  return hash.value();
}

std::uint64_t state_hash(std::span<const DynamicLabel> labels) {
  Fnv hash;
  for (const DynamicLabel& label : labels) {
    hash.add(label.id);
    hash.add(static_cast<std::int64_t>(label.label));
    hash.add(label.residual_px.value_or(-1.0));
  }
  return hash.value();
}

std::uint64_t state_hash(const NavState& state) {
  Fnv hash;
  hash.add(state.T_w_b.p);
  hash.add(Eigen::Vector4d(state.T_w_b.q.coeffs()));
  hash.add(state.v_w);
  hash.add(state.gyro_bias);
  hash.add(state.accel_bias);
  return hash.value();
}

namespace {

constexpr double kRelative = 1e-9;  // r

enum class Stream : std::uint64_t { kGyro = 1, kFeature };

/// Key of one stream at one time.
std::uint64_t key_of(int seed, Stream stream, Timestamp t) {
  const std::uint64_t stream_key =
      mix_bits(static_cast<std::uint64_t>(seed) ^ (static_cast<std::uint64_t>(stream) << 56));
  return mix_bits(stream_key + static_cast<std::uint64_t>(t.ns));
}

/// r u.
double relative_change(std::uint64_t key, std::uint64_t counter) {
  const double uniform = static_cast<double>(mix_bits(key + counter) >> 11) * 0x1.0p-53;  // in [0, 1)
  return kRelative * (2.0 * uniform - 1.0);
}

}  // namespace

ImuSample InputPerturbation::of(const ImuSample& sample) const {
  if (seed_ == 0) return sample;
  ImuSample perturbed = sample;
  const std::uint64_t key = key_of(seed_, Stream::kGyro, sample.t);
  for (std::uint64_t axis = 0; axis < 3; ++axis)
    perturbed.gyro_b[static_cast<Eigen::Index>(axis)] *= 1.0 + relative_change(key, axis);
  return perturbed;
}

void InputPerturbation::perturb(TrackedFrame& frame) const {
  if (seed_ == 0) return;
  const std::uint64_t key = key_of(seed_, Stream::kFeature, frame.t);
  for (TrackedFeature& feature : frame.features) {
    const std::uint64_t counter = 2 * static_cast<std::uint64_t>(feature.id);
    const Eigen::Vector2d change(feature.pixel.x() * relative_change(key, counter),
                                 feature.pixel.y() * relative_change(key, counter + 1));
    feature.pixel += change;
    feature.bearing += change / focal_px_;
  }
}

}  // namespace stillpoint
