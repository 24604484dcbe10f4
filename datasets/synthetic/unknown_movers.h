// SPDX-License-Identifier: BSD-3-Clause
/// Things that move without anybody a detector would know: a loaded cart, an office chair.
#pragma once

#include "datasets/synthetic/actor.h"
#include "datasets/synthetic/furniture.h"
#include "datasets/synthetic/walk.h"

namespace stillpoint {

/// A platform trolley with cartons and packed goods, rolling along its way.
[[nodiscard]] Actor make_cart(const Palette& palette, int object, const Walk& walk, std::uint64_t random_key);

/// An office chair that rolls and turns.
[[nodiscard]] Actor make_rolling_chair(const Palette& palette, int object, const Walk& walk,
                                       std::uint64_t random_key);

}  // namespace stillpoint
