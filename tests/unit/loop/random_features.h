// SPDX-License-Identifier: BSD-3-Clause
/// Keyframes with random descriptors and points.
#pragma once

#include <random>
#include <vector>

#include "core/loop/keyframe.h"

namespace stillpoint {

inline Descriptor random_descriptor(std::mt19937_64& random) {
  return {random(), random(), random(), random()};
}

/// The descriptor with `count` random bits inverted, some of them maybe twice.
inline Descriptor with_flipped_bits(Descriptor descriptor, int count, std::mt19937_64& random) {
  for (int i = 0; i < count; ++i) {
    const std::uint64_t bit = random() % 256;
    descriptor[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

/// Points in front of the camera, 1 to 6 m.
inline std::vector<KeyframeFeature> random_features(int count, std::mt19937_64& random) {
  std::uniform_real_distribution<float> lateral(-0.5F, 0.5F);
  std::uniform_real_distribution<float> depth(1.0F, 6.0F);
  std::vector<KeyframeFeature> features;
  for (int i = 0; i < count; ++i) {
    const float z = depth(random);
    features.push_back({random_descriptor(random), {lateral(random) * z, lateral(random) * z, z}});
  }
  return features;
}

/// The same points seen from another pose, with noisy descriptors.
inline std::vector<KeyframeFeature> revisited(const std::vector<KeyframeFeature>& features, const Pose& T_m_q,
                                              std::mt19937_64& random) {
  std::vector<KeyframeFeature> result;
  for (const KeyframeFeature& feature : features) {
    const Eigen::Vector3d p_q = T_m_q.inverse() * feature.p_c.cast<double>();
    result.push_back({with_flipped_bits(feature.descriptor, 20, random), p_q.cast<float>()});
  }
  return result;
}

}  // namespace stillpoint
