// SPDX-License-Identifier: BSD-3-Clause
/// Fingerprints of what the modules hold after a picture: the first one that differs between two runs tells
/// where they parted.
#pragma once

#include <span>

#include "core/types/feature_verdict.h"
#include "core/types/nav_state.h"
#include "core/types/odometry_update.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// FNV-1a, 64 bits (Fowler, Noll, Vo 1991), over the bits of every number.
[[nodiscard]] std::uint64_t state_hash(std::span<const TrackedFeature> features);
[[nodiscard]] std::uint64_t state_hash(std::span<const FeatureVerdict> verdicts);
[[nodiscard]] std::uint64_t state_hash(const NavState& state);

}  // namespace stillpoint
