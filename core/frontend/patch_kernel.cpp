// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/patch_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/frontend/patch_geometry.h"

// Highway compiles what lies between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction
// set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/frontend/patch_kernel.cpp"
#include <hwy/foreach_target.h>
// Its order matters: after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillpoint::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kSide = kPatchSide;
constexpr std::size_t kArea = kSide * kSide;
constexpr float kCoarseConverged_px = 0.1F;  // enough for the next finer level to begin

/// A row of the patch, or as much of it as a register holds.
using Row = hn::CappedTag<float, kSide>;
using Vector = hn::Vec<Row>;
using Bytes = hn::Rebind<std::uint8_t, Row>;
using Integers = hn::Rebind<std::int32_t, Row>;
/// One sum for each column of the patch.
using Columns = std::array<float, kSide>;

/// In an order that no register's width changes.
float sum_of(const Columns& columns) {
  return ((columns[0] + columns[4]) + (columns[2] + columns[6])) +
         ((columns[1] + columns[5]) + (columns[3] + columns[7]));
}

HWY_INLINE Vector load(Row row, const std::uint8_t* pixels) {
  return hn::ConvertTo(row, hn::PromoteTo(Integers(), hn::LoadU(Bytes(), pixels)));
}

/// a + share * (b - a)
HWY_INLINE Vector blend(Vector a, Vector b, Vector share) {
  return hn::Add(a, hn::Mul(share, hn::Sub(b, a)));
}

/// A patch and what the search needs of it.
struct Patch {
  HWY_ALIGN std::array<float, kArea> grey;  ///< these three without their means
  HWY_ALIGN std::array<float, kArea> by_x;
  HWY_ALIGN std::array<float, kArea> by_y;
  PatchPoint slope;   ///< sums of by_x * grey and by_y * grey
  Tensor tensor;      ///< sums of products of the gradients
  float norm = 0.0F;  ///< root of the sum of grey^2
};

/// Sums over the patch as it was sampled: grey, by_x, by_y and their products.
enum Moment : std::size_t { kG, kX, kY, kGG, kGX, kGY, kXX, kXY, kYY, kMoments };
using Moments = std::array<float, kMoments>;

/// The same of one row, or of rows above each other.
struct MomentRow {
  std::array<Vector, kMoments> sums;

  HWY_INLINE void add(Vector g, Vector x, Vector y) {
    const Vector terms[] = {
        g, x, y, hn::Mul(g, g), hn::Mul(g, x), hn::Mul(g, y), hn::Mul(x, x), hn::Mul(x, y), hn::Mul(y, y)};
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = hn::Add(sums[i], terms[i]);
  }
};

/// Grey values and gradients by central differences, all interpolated, as they are.
Moments sample(const Place& place, Patch& patch) {
  const Row row;
  const Vector share_x = hn::Set(row, place.share_x);
  const Vector share_y = hn::Set(row, place.share_y);
  const Vector half = hn::Set(row, 0.5F);
  std::array<Columns, kMoments> columns;
  for (std::size_t x = 0; x < kSide; x += hn::Lanes(row)) {
    const std::uint8_t* pixels = place.pixels - place.stride + x;
    MomentRow moments;
    moments.sums.fill(hn::Zero(row));
    // Between rows of pixels lie the rows of the patch; each is the middle one when the next is known.
    Vector upper = hn::Zero(row);
    Vector middle = hn::Zero(row);
    Vector across_middle = hn::Zero(row);
    Vector last = hn::Zero(row);
    Vector across_last = hn::Zero(row);
    for (std::size_t y = 0; y < kSide + 3; ++y, pixels += place.stride) {
      const Vector p0 = load(row, pixels);
      const Vector p1 = load(row, pixels + 1);
      const Vector centre = blend(p0, p1, share_x);
      const Vector across =
          hn::Sub(blend(p1, load(row, pixels + 2), share_x), blend(load(row, pixels - 1), p0, share_x));
      const Vector lower = blend(last, centre, share_y);
      if (y > 2) {
        const std::size_t at = (y - 3) * kSide + x;
        const Vector by_x = hn::Mul(half, across_middle);
        const Vector by_y = hn::Mul(half, hn::Sub(lower, upper));
        moments.add(middle, by_x, by_y);
        hn::Store(middle, row, patch.grey.data() + at);
        hn::Store(by_x, row, patch.by_x.data() + at);
        hn::Store(by_y, row, patch.by_y.data() + at);
      }
      upper = middle;
      middle = lower;
      across_middle = blend(across_last, across, share_y);
      last = centre;
      across_last = across;
    }
    for (std::size_t i = 0; i < columns.size(); ++i) hn::StoreU(moments.sums[i], row, columns[i].data() + x);
  }
  Moments total;
  for (std::size_t i = 0; i < columns.size(); ++i) total[i] = sum_of(columns[i]);
  return total;
}

void remove_means(const Moments& m, Patch& patch) {
  const Row row;
  const Vector mean_grey = hn::Set(row, m[kG] * (1.0F / kArea));
  const Vector mean_x = hn::Set(row, m[kX] * (1.0F / kArea));
  const Vector mean_y = hn::Set(row, m[kY] * (1.0F / kArea));
  for (std::size_t at = 0; at < kArea; at += hn::Lanes(row)) {
    hn::Store(hn::Sub(hn::Load(row, patch.grey.data() + at), mean_grey), row, patch.grey.data() + at);
    hn::Store(hn::Sub(hn::Load(row, patch.by_x.data() + at), mean_x), row, patch.by_x.data() + at);
    hn::Store(hn::Sub(hn::Load(row, patch.by_y.data() + at), mean_y), row, patch.by_y.data() + at);
  }
}

/// @return false where there is too little texture
bool prepare(const Place& place, float min_eigenvalue, Patch& patch) {
  const Moments m = sample(place, patch);
  constexpr float kShare = 1.0F / kArea;
  patch.tensor = {.xx = m[kXX] - m[kX] * m[kX] * kShare,
                  .xy = m[kXY] - m[kX] * m[kY] * kShare,
                  .yy = m[kYY] - m[kY] * m[kY] * kShare};
  if (!(patch.tensor.smaller_eigenvalue() >= min_eigenvalue * kArea)) return false;
  remove_means(m, patch);
  patch.slope = {m[kGX] - m[kG] * m[kX] * kShare, m[kGY] - m[kG] * m[kY] * kShare};
  patch.norm = std::sqrt(m[kGG] - m[kG] * m[kG] * kShare);
  return true;
}

/// Calls use(row of the patch, grey values there) for one column of registers.
template <class Use>
HWY_INLINE void for_each_row(const Place& place, std::size_t x, Use use) {
  const Row row;
  const Vector share_x = hn::Set(row, place.share_x);
  const Vector share_y = hn::Set(row, place.share_y);
  const std::uint8_t* pixels = place.pixels + x;
  Vector upper = blend(load(row, pixels), load(row, pixels + 1), share_x);
  for (std::size_t y = 0; y < kSide; ++y) {
    pixels += place.stride;
    const Vector lower = blend(load(row, pixels), load(row, pixels + 1), share_x);
    use(y * kSide + x, blend(upper, lower, share_y));
    upper = lower;
  }
}

/// Half the gradient of the squared misfit here.
PatchPoint slope_at(const Place& place, const Patch& patch) {
  const Row row;
  Columns sums_x, sums_y;
  for (std::size_t x = 0; x < kSide; x += hn::Lanes(row)) {
    Vector sum_x = hn::Zero(row);
    Vector sum_y = hn::Zero(row);
    for_each_row(place, x, [&](std::size_t at, Vector grey) HWY_ATTR {
      sum_x = hn::Add(sum_x, hn::Mul(grey, hn::Load(row, patch.by_x.data() + at)));
      sum_y = hn::Add(sum_y, hn::Mul(grey, hn::Load(row, patch.by_y.data() + at)));
    });
    hn::StoreU(sum_x, row, sums_x.data() + x);
    hn::StoreU(sum_y, row, sums_y.data() + x);
  }
  return {sum_of(sums_x) - patch.slope.x, sum_of(sums_y) - patch.slope.y};
}

/// Normalised cross-correlation of the patch with what is here, in [-1, 1].
float correlation(const Place& place, const Patch& patch) {
  const Row row;
  Columns sums, squares, products;
  for (std::size_t x = 0; x < kSide; x += hn::Lanes(row)) {
    Vector sum = hn::Zero(row);
    Vector square = hn::Zero(row);
    Vector product = hn::Zero(row);
    for_each_row(place, x, [&](std::size_t at, Vector grey) HWY_ATTR {
      sum = hn::Add(sum, grey);
      square = hn::Add(square, hn::Mul(grey, grey));
      product = hn::Add(product, hn::Mul(grey, hn::Load(row, patch.grey.data() + at)));
    });
    hn::StoreU(sum, row, sums.data() + x);
    hn::StoreU(square, row, squares.data() + x);
    hn::StoreU(product, row, products.data() + x);
  }
  const float total = sum_of(sums);
  const float variance = sum_of(squares) - total * total * (1.0F / kArea);
  return variance > 0.0F ? sum_of(products) / (patch.norm * std::sqrt(variance)) : 0.0F;
}

/// A patch of one level, perhaps joined by that of the next coarser one around the same point.
struct Target {
  const Patch* patch;
  const PatchImage* image;
  const Patch* coarse = nullptr;
  const PatchImage* coarse_image = nullptr;
};

/// The way from `match` to where the target fits better. @return false where it leaves the picture
bool step_from(const Target& target, PatchPoint match, PatchPoint& step) {
  Place place;
  if (!place_at(*target.image, match, place)) return false;
  PatchPoint slope = slope_at(place, *target.patch);
  Tensor tensor = target.patch->tensor;
  if (target.coarse != nullptr) {
    if (!place_at(*target.coarse_image, {0.5F * match.x, 0.5F * match.y}, place)) return false;
    slope = joined(slope, slope_at(place, *target.coarse));
    tensor = joined(tensor, target.coarse->tensor);
  }
  step = newton_step(tensor, slope);
  return true;
}

/// Walks to where the target fits. @return false where it leaves the picture
bool walk(const Target& target, int max_iterations, float converged_px, PatchPoint& match) {
  PatchPoint step;
  for (int i = 0; i < max_iterations; ++i) {
    if (!step_from(target, match, step)) return false;
    match = {match.x + step.x, match.y + step.y};
    if (step.x * step.x + step.y * step.y < converged_px * converged_px) break;
  }
  Place place;
  return place_at(*target.image, match, place);
}

bool prepare_at(const PatchImage& image, PatchPoint centre, float min_eigenvalue, Patch& patch) {
  Place place;
  return place_at(image, centre, place) && prepare(place, min_eigenvalue, patch);
}

bool track_patch(const PatchSearch& search, PatchPoint point, const PatchSettings& settings,
                 PatchPoint& match) {
  std::array<Patch, 2> patches;  // the last two levels, by parity
  bool textured = false;
  for (std::size_t level = search.from.size(); level-- > 0;) {
    const float scale = 1.0F / static_cast<float>(1U << level);
    const bool coarser_textured = textured;
    Patch& patch = patches[level % 2];
    textured =
        prepare_at(search.from[level], {point.x * scale, point.y * scale}, settings.min_eigenvalue, patch);
    if (!textured) continue;  // a coarse level without texture leaves it to the finer ones
    Target target{.patch = &patch, .image = &search.to[level]};
    if (level == 0 && coarser_textured) {
      target.coarse = &patches[1];
      target.coarse_image = &search.to[1];
    }
    PatchPoint scaled{match.x * scale, match.y * scale};
    const float converged_px = level > 0 ? kCoarseConverged_px : settings.converged_px;
    const bool inside = walk(target, settings.max_iterations, converged_px, scaled);
    if (inside || level == 0) match = {scaled.x / scale, scaled.y / scale};
    if (!inside && level == 0) return false;
  }
  Place place;
  return textured && place_at(search.to[0], match, place) &&
         correlation(place, patches[0]) >= settings.min_correlation;
}

void track_patches(const PatchSearch& search, const PatchSettings& settings) {
  for (std::size_t i = 0; i < search.points.size(); ++i) {
    const bool found = track_patch(search, search.points[i], settings, search.matches[i]);
    search.found[i] = found ? 1 : 0;
  }
}

}  // namespace stillpoint::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillpoint {

// Compilers differ in the target that needs no instruction set (g++ before 12.3 cannot compile EMU128).
#if HWY_BASELINE_SCALAR == HWY_SCALAR
namespace portable = N_SCALAR;
#else
namespace portable = N_EMU128;
#endif

HWY_EXPORT(track_patches);

void track_patches(const PatchSearch& search, const PatchSettings& settings, PatchTarget target) {
  if (target == PatchTarget::kPortable) {
    portable::track_patches(search, settings);
  } else {
    HWY_DYNAMIC_DISPATCH(track_patches)(search, settings);
  }
}

}  // namespace stillpoint
#endif
