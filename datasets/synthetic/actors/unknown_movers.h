// SPDX-License-Identifier: BSD-3-Clause
/// Moving objects of classes that a person detector does not report: a loaded cart, an office chair.
#pragma once

#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/actors/walk.h"
#include "datasets/synthetic/scenes/furniture.h"

namespace stillpoint::synth {

/// A platform trolley with cartons and packages that follows `walk`.
[[nodiscard]] Actor make_cart(const Palette& palette, int object, const Walk& walk, std::uint64_t random_key);

/// An office chair that follows `walk` and oscillates about its vertical axis.
[[nodiscard]] Actor make_rolling_chair(const Palette& palette, int object, const Walk& walk,
                                       std::uint64_t random_key);

}  // namespace stillpoint::synth
