// SPDX-License-Identifier: BSD-3-Clause
/// Hashes of the module states after each frame. The first difference between two runs locates their
/// divergence.
#pragma once

#include <span>

#include "core/types/nav_state.h"
#include "core/types/odometry_update.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// FNV-1a, 64 bits (Fowler, Noll, Vo 1991), over the bit patterns of all values.
[[nodiscard]] std::uint64_t state_hash(std::span<const TrackedFeature> features);
[[nodiscard]] std::uint64_t state_hash(std::span<const DynamicLabel> labels);
[[nodiscard]] std::uint64_t state_hash(const NavState& state);

}  // namespace stillpoint
