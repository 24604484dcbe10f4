// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/fast_kernel.h"

#include <algorithm>
#include <array>

// Highway compiles what lies between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction
// set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/frontend/fast_kernel.cpp"
#include <hwy/foreach_target.h>
// Its order matters: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillpoint::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kCircle = 16;

struct Lesser {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};

struct Greater {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};

/// The greatest, over all arcs of 9, of the least on the arc; the other way round with Greater, Lesser.
template <class V, class Least, class Greatest>
HWY_INLINE V best_arc(const std::array<V, kCircle>& circle, Least least, Greatest greatest) {
  std::array<V, kCircle> two;
  for (std::size_t i = 0; i < kCircle; ++i) two[i] = least(circle[i], circle[(i + 1) % kCircle]);
  std::array<V, kCircle> four;
  for (std::size_t i = 0; i < kCircle; ++i) four[i] = least(two[i], two[(i + 2) % kCircle]);
  V best = hn::Zero(hn::DFromV<V>());
  for (std::size_t i = 0; i < kCircle; ++i) {
    const V nine = least(least(four[i], four[(i + 4) % kCircle]), circle[(i + 8) % kCircle]);
    best = i == 0 ? nine : greatest(best, nine);
  }
  return best;
}

/// Whether any of the pixels can be a corner: every arc of 9 holds two neighbours of the four points on the
/// axes.
template <class D>
HWY_INLINE bool promises(D lanes, const std::uint8_t* pixels, std::ptrdiff_t stride, hn::Vec<D> threshold) {
  using V = hn::Vec<D>;
  const V own = hn::LoadU(lanes, pixels);
  const V right = hn::LoadU(lanes, pixels + 3);
  const V left = hn::LoadU(lanes, pixels - 3);
  const V below = hn::LoadU(lanes, pixels + 3 * stride);
  const V above = hn::LoadU(lanes, pixels - 3 * stride);
  // The best pair takes one of left and right, and one of above and below.
  const V bright = hn::Min(hn::Max(left, right), hn::Max(above, below));
  const V dark = hn::Max(hn::Min(left, right), hn::Min(above, below));
  const V most = hn::Max(hn::SaturatedSub(bright, own), hn::SaturatedSub(own, dark));
  return !hn::AllTrue(lanes, hn::Eq(hn::SaturatedSub(most, threshold), hn::Zero(lanes)));
}

template <class D>
HWY_INLINE void score(D lanes, const std::uint8_t* pixels, std::ptrdiff_t stride, int threshold,
                      std::uint8_t* scores) {
  using V = hn::Vec<D>;
  const V least = hn::Set(lanes, static_cast<std::uint8_t>(threshold));
  if (!promises(lanes, pixels, stride, least)) {
    hn::StoreU(hn::Zero(lanes), lanes, scores);
    return;
  }
  constexpr std::array<std::ptrdiff_t, kCircle> kX = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr std::array<std::ptrdiff_t, kCircle> kY = {3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3};
  std::array<V, kCircle> circle;
  for (std::size_t i = 0; i < kCircle; ++i) circle[i] = hn::LoadU(lanes, pixels + kY[i] * stride + kX[i]);
  const V own = hn::LoadU(lanes, pixels);
  const V brighter = hn::SaturatedSub(best_arc(circle, Lesser(), Greater()), own);
  const V darker = hn::SaturatedSub(own, best_arc(circle, Greater(), Lesser()));
  const V contrast = hn::Max(brighter, darker);
  const auto weak = hn::Eq(hn::SaturatedSub(contrast, least), hn::Zero(lanes));
  hn::StoreU(hn::IfThenZeroElse(weak, hn::Sub(contrast, hn::Set(lanes, std::uint8_t{1}))), lanes, scores);
}

/// The last registers look at some pixels again; a row narrower than one is done pixel by pixel.
void score_row(const std::uint8_t* pixels, std::ptrdiff_t stride, int threshold,
               std::span<std::uint8_t> scores) {
  const hn::ScalableTag<std::uint8_t> lanes;
  const hn::CappedTag<std::uint8_t, 1> single;
  const std::size_t width = hn::Lanes(lanes);
  if (scores.size() < width) {
    for (std::size_t x = 0; x < scores.size(); ++x) {
      score(single, pixels + x, stride, threshold, scores.data() + x);
    }
    return;
  }
  for (std::size_t x = 0; x < scores.size(); x += width) {
    const std::size_t from = std::min(x, scores.size() - width);
    score(lanes, pixels + from, stride, threshold, scores.data() + from);
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
