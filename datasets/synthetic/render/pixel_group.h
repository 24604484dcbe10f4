// SPDX-License-Identifier: BSD-3-Clause
/// Eight pixels or tiles of a row that are treated together, in vectors that are a compiler extension of GCC
/// and Clang.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace stillpoint::synth {

inline constexpr int kLanes = 8;
using Floats = float __attribute__((vector_size(4 * kLanes)));
using Integers = std::int32_t __attribute__((vector_size(4 * kLanes)));

template <class Vector, class T>
Vector load(const T* from) {
  Vector values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

/// Replaces the values in the lanes that are so.
template <class Vector, class T>
void store_where(const Integers& is_so, const Vector& values, T* to) {
  const Vector stored = is_so ? values : load<Vector>(to);
  std::memcpy(to, &stored, sizeof stored);
}

inline constexpr std::uint32_t kAllLanes = (1U << kLanes) - 1;

/// Lanes that are so, as bits.
inline std::uint32_t lanes_where(const Integers& is_so) {
#ifdef __AVX__
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(std::bit_cast<Floats>(is_so)));
#else
  std::uint32_t lanes = 0;
  for (int lane = 0; lane < kLanes; ++lane) lanes |= is_so[lane] != 0 ? 1U << lane : 0U;
  return lanes;
#endif
}

}  // namespace stillpoint::synth
