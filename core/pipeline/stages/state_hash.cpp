// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/state_hash.h"

#include <bit>

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

}  // namespace stillpoint
