// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/fast_kernel.h"

#include <algorithm>
#include <array>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/frontend/detect/fast_kernel.cpp"
#include <hwy/foreach_target.h>
// Must be included after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillpoint::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kCircle = 16;

struct MinOf {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};

struct MaxOf {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};

/// With (MinOf, MaxOf): the maximum over all arcs of 9 of the minimum on the arc; min-max with (MaxOf,
/// MinOf).
template <class V, class Least, class Greatest>
HWY_INLINE V best_arc(const std::array<V, kCircle>& circle, Least least, Greatest greatest) {
  std::array<V, kCircle> two;
  for (std::size_t i = 0; i < kCircle; ++i) two[i] = least(circle[i], circle[(i + 1) % kCircle]);
  std::array<V, kCircle> four;
  for (std::size_t i = 0; i < kCircle; ++i) four[i] = least(two[i], two[(i + 2) % kCircle]);
  V best = hn::Zero(hn::DFromV<V>());
  for (std::size_t i = 0; i < kCircle; ++i) {
    const V arc = least(least(four[i], four[(i + 4) % kCircle]), circle[(i + 8) % kCircle]);
    best = i == 0 ? arc : greatest(best, arc);
  }
  return best;
}

/// Pixels from some position in an image on.
struct PixelRow {
  const std::uint8_t* pixels;
  std::ptrdiff_t stride;  ///< [bytes]
};

/// Quick rejection test: whether any of the pixels can be a corner. Every arc of 9 contains two adjacent
/// pixels of the four on the axes.
template <class D>
HWY_INLINE bool may_contain_corner(D lanes, PixelRow row, hn::Vec<D> threshold) {
  using V = hn::Vec<D>;
  const auto [pixels, stride] = row;
  const V own = hn::LoadU(lanes, pixels);
  const V right = hn::LoadU(lanes, pixels + 3);
  const V left = hn::LoadU(lanes, pixels - 3);
  const V below = hn::LoadU(lanes, pixels + 3 * stride);
  const V above = hn::LoadU(lanes, pixels - 3 * stride);
  // An adjacent pair consists of left or right and above or below.
  const V bright = hn::Min(hn::Max(left, right), hn::Max(above, below));
  const V dark = hn::Max(hn::Min(left, right), hn::Min(above, below));
  const V most = hn::Max(hn::SaturatedSub(bright, own), hn::SaturatedSub(own, dark));
  return !hn::AllTrue(lanes, hn::Eq(hn::SaturatedSub(most, threshold), hn::Zero(lanes)));
}

template <class D>
HWY_INLINE void score(D lanes, PixelRow row, int threshold, std::uint8_t* scores) {
  using V = hn::Vec<D>;
  const auto [pixels, stride] = row;
  const V least = hn::Set(lanes, static_cast<std::uint8_t>(threshold));
  if (!may_contain_corner(lanes, row, least)) {
    hn::StoreU(hn::Zero(lanes), lanes, scores);
    return;
  }
  constexpr std::array<std::ptrdiff_t, kCircle> kX = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr std::array<std::ptrdiff_t, kCircle> kY = {3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3};
  std::array<V, kCircle> circle;
  for (std::size_t i = 0; i < kCircle; ++i) circle[i] = hn::LoadU(lanes, pixels + kY[i] * stride + kX[i]);
  const V own = hn::LoadU(lanes, pixels);
  const V brighter = hn::SaturatedSub(best_arc(circle, MinOf(), MaxOf()), own);
  const V darker = hn::SaturatedSub(own, best_arc(circle, MaxOf(), MinOf()));
  const V contrast = hn::Max(brighter, darker);
  const auto weak = hn::Eq(hn::SaturatedSub(contrast, least), hn::Zero(lanes));
  hn::StoreU(hn::IfThenZeroElse(weak, hn::Sub(contrast, hn::Set(lanes, std::uint8_t{1}))), lanes, scores);
}

/// The last register overlaps the one before it; rows narrower than a register are processed pixel by pixel.
void score_row(const std::uint8_t* pixels, std::ptrdiff_t stride, int threshold,
               std::span<std::uint8_t> scores) {
  const hn::ScalableTag<std::uint8_t> lanes;
  const hn::CappedTag<std::uint8_t, 1> single;
  const std::size_t width = hn::Lanes(lanes);
  if (scores.size() < width) {
    for (std::size_t x = 0; x < scores.size(); ++x) {
      score(single, {pixels + x, stride}, threshold, scores.data() + x);
    }
    return;
  }
  for (std::size_t x = 0; x < scores.size(); x += width) {
    const std::size_t from = std::min(x, scores.size() - width);
    score(lanes, {pixels + from, stride}, threshold, scores.data() + from);
  }
}

}  // namespace stillpoint::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillpoint {

HWY_EXPORT(score_row);

void score_fast_row(const std::uint8_t* pixels, std::ptrdiff_t stride, int threshold,
                    std::span<std::uint8_t> scores) {
  HWY_DYNAMIC_DISPATCH(score_row)(pixels, stride, threshold, scores);
}

}  // namespace stillpoint
#endif
