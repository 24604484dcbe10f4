// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/patch/patch_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/frontend/patch/patch_geometry.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/frontend/patch/patch_kernel.cpp"
#include <hwy/foreach_target.h>
// Must be included after foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stillpoint::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kSide = kPatchSide;
constexpr std::size_t kArea = kSide * kSide;
constexpr float kCoarseConverged_px = 0.1F;  // sufficient as initial guess of the next finer level

/// A row of the patch, or the part of it that fits into a register.
using Row = hn::CappedTag<float, kSide>;
using Vector = hn::Vec<Row>;
using Bytes = hn::Rebind<std::uint8_t, Row>;
using Integers = hn::Rebind<std::int32_t, Row>;
/// One sum for each column of the patch.
using Columns = std::array<float, kSide>;

/// Sum in an order that does not depend on the register width.
float sum_of(const Columns& columns) {
  return ((columns[0] + columns[4]) + (columns[2] + columns[6])) +
         ((columns[1] + columns[5]) + (columns[3] + columns[7]));
}

HWY_INLINE Vector load(Row row, const std::uint8_t* pixels) {
  return hn::ConvertTo(row, hn::PromoteTo(Integers(), hn::LoadU(Bytes(), pixels)));
}

/// a + weight * (b - a)
HWY_INLINE Vector blend(Vector a, Vector b, Vector weight) {
  return hn::Add(a, hn::Mul(weight, hn::Sub(b, a)));
}

/// The template: intensities and gradients of a patch, and the terms of the search that depend only on it.
struct Patch {
  /// @return false if the patch has too little texture
  bool extract(const PatchSampler& sampler, float min_eigenvalue);

  HWY_ALIGN std::array<float, kArea> grey;    ///< T - mean(T)
  HWY_ALIGN std::array<float, kArea> grad_x;  ///< G = grad T - mean(grad T)
  HWY_ALIGN std::array<float, kArea> grad_y;
  PatchPoint template_term;  ///< sum of G T
  StructureTensor hessian;   ///< sum of G G^T
  float norm = 0.0F;         ///< square root of the sum of grey^2

 private:
  Moments sample(const PatchSampler& sampler);
  void remove_means(const Moments& m);
};

/// The same sums per column, accumulated over rows.
struct MomentRow {
  std::array<Vector, kMoments> sums;

  HWY_INLINE void add(Vector g, Vector x, Vector y) {
    const Vector terms[] = {
        g, x, y, hn::Mul(g, g), hn::Mul(g, x), hn::Mul(g, y), hn::Mul(x, x), hn::Mul(x, y), hn::Mul(y, y)};
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = hn::Add(sums[i], terms[i]);
  }
};

/// Bilinearly interpolated intensities and central-difference gradients, without removing the means.
Moments Patch::sample(const PatchSampler& sampler) {
  const Row row;
  const Vector frac_x = hn::Set(row, sampler.frac_x), frac_y = hn::Set(row, sampler.frac_y);
  const Vector half = hn::Set(row, 0.5F);
  std::array<Columns, kMoments> columns;
  for (std::size_t x = 0; x < kSide; x += hn::Lanes(row)) {
    const std::uint8_t* pixels = sampler.pixels - sampler.stride + x;
    MomentRow moments;
    moments.sums.fill(hn::Zero(row));
    // Rows of the patch are interpolated between rows of pixels; grad_y of a row needs the next one.
    Vector upper, middle, diff_x_middle, previous, diff_x_last;
    upper = middle = diff_x_middle = previous = diff_x_last = hn::Zero(row);
    for (std::size_t y = 0; y < kSide + 3; ++y, pixels += sampler.stride) {
      const Vector p0 = load(row, pixels);
      const Vector p1 = load(row, pixels + 1);
      const Vector center = blend(p0, p1, frac_x);
      const Vector diff_x =
          hn::Sub(blend(p1, load(row, pixels + 2), frac_x), blend(load(row, pixels - 1), p0, frac_x));
      const Vector lower = blend(previous, center, frac_y);
      if (y > 2) {
        const std::size_t at = (y - 3) * kSide + x;
        const Vector slope_x = hn::Mul(half, diff_x_middle);
        const Vector slope_y = hn::Mul(half, hn::Sub(lower, upper));
        moments.add(middle, slope_x, slope_y);
        hn::Store(middle, row, grey.data() + at);
        hn::Store(slope_x, row, grad_x.data() + at);
        hn::Store(slope_y, row, grad_y.data() + at);
      }
      upper = middle;
      middle = lower;
      diff_x_middle = blend(diff_x_last, diff_x, frac_y);
      previous = center;
      diff_x_last = diff_x;
    }
    for (std::size_t i = 0; i < columns.size(); ++i) hn::StoreU(moments.sums[i], row, columns[i].data() + x);
  }
  Moments total;
  for (std::size_t i = 0; i < columns.size(); ++i) total[i] = sum_of(columns[i]);
  return total;
}

void Patch::remove_means(const Moments& m) {
  const Row row;
  const Vector mean_grey = hn::Set(row, m[kG] * (1.0F / kArea));
  const Vector mean_x = hn::Set(row, m[kX] * (1.0F / kArea));
  const Vector mean_y = hn::Set(row, m[kY] * (1.0F / kArea));
  for (std::size_t at = 0; at < kArea; at += hn::Lanes(row)) {
    hn::Store(hn::Sub(hn::Load(row, grey.data() + at), mean_grey), row, grey.data() + at);
    hn::Store(hn::Sub(hn::Load(row, grad_x.data() + at), mean_x), row, grad_x.data() + at);
    hn::Store(hn::Sub(hn::Load(row, grad_y.data() + at), mean_y), row, grad_y.data() + at);
  }
}

bool Patch::extract(const PatchSampler& sampler, float min_eigenvalue) {
  const Moments m = sample(sampler);
  constexpr float kInverseArea = 1.0F / kArea;
  hessian = {.xx = m[kXX] - m[kX] * m[kX] * kInverseArea,
             .xy = m[kXY] - m[kX] * m[kY] * kInverseArea,
             .yy = m[kYY] - m[kY] * m[kY] * kInverseArea};
  if (!(hessian.smaller_eigenvalue() >= min_eigenvalue * kArea)) return false;
  remove_means(m);
  template_term = {m[kGX] - m[kG] * m[kX] * kInverseArea, m[kGY] - m[kG] * m[kY] * kInverseArea};
  norm = std::sqrt(m[kGG] - m[kG] * m[kG] * kInverseArea);
  return true;
}

/// Calls use(index into the patch, interpolated intensities) for each row of the register column at x.
template <class Use>
HWY_INLINE void for_each_row(const PatchSampler& sampler, std::size_t x, Use use) {
  const Row row;
  const Vector frac_x = hn::Set(row, sampler.frac_x);
  const Vector frac_y = hn::Set(row, sampler.frac_y);
  const std::uint8_t* pixels = sampler.pixels + x;
  Vector upper = blend(load(row, pixels), load(row, pixels + 1), frac_x);
  for (std::size_t y = 0; y < kSide; ++y) {
    pixels += sampler.stride;
    const Vector lower = blend(load(row, pixels), load(row, pixels + 1), frac_x);
    use(y * kSide + x, blend(upper, lower, frac_y));
    upper = lower;
  }
}

/// g = sum of G (I - T): half the gradient of the squared error at this position.
PatchPoint gradient_at(const PatchSampler& sampler, const Patch& patch) {
  const Row row;
  Columns sums_x, sums_y;
  for (std::size_t x = 0; x < kSide; x += hn::Lanes(row)) {
    Vector sum_x = hn::Zero(row);
    Vector sum_y = hn::Zero(row);
    for_each_row(sampler, x, [&](std::size_t at, Vector grey) HWY_ATTR {
      sum_x = hn::Add(sum_x, hn::Mul(grey, hn::Load(row, patch.grad_x.data() + at)));
      sum_y = hn::Add(sum_y, hn::Mul(grey, hn::Load(row, patch.grad_y.data() + at)));
    });
    hn::StoreU(sum_x, row, sums_x.data() + x);
    hn::StoreU(sum_y, row, sums_y.data() + x);
  }
  return {sum_of(sums_x) - patch.template_term.x, sum_of(sums_y) - patch.template_term.y};
}

/// Zero-mean normalized cross-correlation of the patch with the image at this position, in [-1, 1].
float correlation(const PatchSampler& sampler, const Patch& patch) {
  const Row row;
  Columns sums, squares, products;
  for (std::size_t x = 0; x < kSide; x += hn::Lanes(row)) {
    Vector sum = hn::Zero(row);
    Vector square = hn::Zero(row);
    Vector product = hn::Zero(row);
    for_each_row(sampler, x, [&](std::size_t at, Vector grey) HWY_ATTR {
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

/// A patch of one level, optionally combined with the patch of the next coarser level at the same point.
struct PatchTemplate {
  const Patch* patch;
  const PatchImage* image;
  const Patch* coarse = nullptr;
  const PatchImage* coarse_image = nullptr;
};

/// Gauss-Newton step at `match`; nullopt if the patch center is outside the image.
HWY_INLINE std::optional<PatchPoint> compute_step(const PatchTemplate& tmpl, PatchPoint match) {
  const std::optional<PatchSampler> sampler = make_sampler(*tmpl.image, match);
  if (!sampler) return std::nullopt;
  PatchPoint gradient = gradient_at(*sampler, *tmpl.patch);
  StructureTensor hessian = tmpl.patch->hessian;
  if (tmpl.coarse != nullptr) {
    const std::optional<PatchSampler> coarse =
        make_sampler(*tmpl.coarse_image, {0.5F * match.x, 0.5F * match.y});
    if (!coarse) return std::nullopt;
    gradient = add_coarse(gradient, gradient_at(*coarse, *tmpl.coarse));
    hessian = add_coarse(hessian, tmpl.coarse->hessian);
  }
  return gauss_newton_step(hessian, gradient);
}

/// Iterates from `match` to convergence; not found if it leaves the image.
HWY_INLINE PatchMatch iterate(const PatchTemplate& tmpl, PatchPoint match, int max_iterations,
                              float converged_px) {
  for (int i = 0; i < max_iterations; ++i) {
    const std::optional<PatchPoint> step = compute_step(tmpl, match);
    if (!step) return {match, false};
    match = {match.x + step->x, match.y + step->y};
    if (step->x * step->x + step->y * step->y < converged_px * converged_px) break;
  }
  return {match, is_inside(*tmpl.image, match)};
}

PatchMatch track_patch(const PatchSearch& search, PatchPoint point, PatchPoint initial_guess,
                       const PatchSettings& settings) {
  std::array<Patch, 2> patches;  // current and next coarser level, indexed by parity
  PatchPoint match = initial_guess;
  bool valid = false;
  for (std::size_t level = search.from.size(); level-- > 0;) {
    const float scale = 1.0F / static_cast<float>(1U << level);
    const bool coarser_valid = valid;
    Patch& patch = patches[level % 2];
    const std::optional<PatchSampler> sampler =
        make_sampler(search.from[level], {point.x * scale, point.y * scale});
    valid = sampler && patch.extract(*sampler, settings.min_eigenvalue);
    if (!valid) continue;  // levels without texture are skipped
    PatchTemplate tmpl{.patch = &patch, .image = &search.to[level]};
    if (level == 0 && coarser_valid) {
      tmpl.coarse = &patches[1];
      tmpl.coarse_image = &search.to[1];
    }
    const float converged_px = level > 0 ? kCoarseConverged_px : settings.converged_px;
    const auto [scaled, inside] =
        iterate(tmpl, {match.x * scale, match.y * scale}, settings.max_iterations, converged_px);
    if (inside || level == 0) match = {scaled.x / scale, scaled.y / scale};
    if (!inside && level == 0) return {match, false};
  }
  if (!valid) return {match, false};
  const std::optional<PatchSampler> sampler = make_sampler(search.to[0], match);
  return {match, sampler && correlation(*sampler, patches[0]) >= settings.min_correlation};
}

void track_patches(const PatchSearch& search, const PatchSettings& settings) {
  for (std::size_t i = 0; i < search.points.size(); ++i) {
    const PatchMatch match = track_patch(search, search.points[i], search.matches[i], settings);
    search.matches[i] = match.position;
    search.found[i] = match.found ? 1 : 0;
  }
}

}  // namespace stillpoint::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillpoint {

// The name of the portable target depends on the compiler (g++ before 12.3 cannot compile EMU128).
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
