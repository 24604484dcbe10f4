// SPDX-License-Identifier: BSD-3-Clause
/// People: articulated bodies that walk, or sit and make small movements.
#pragma once

#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/actors/walk.h"
#include "datasets/synthetic/scenes/furniture.h"

namespace stillpoint::synth {

/// A walking person. @param object instance number
[[nodiscard]] Actor make_walking_person(Builder& builder, int object, const Walk& walk,
                                        std::uint64_t random_key);

/// A person sitting on the chair at `seat`, facing its front, who moves arms, trunk and head slightly.
[[nodiscard]] Actor make_seated_person(Builder& builder, int object, const Placement& seat,
                                       std::uint64_t random_key);

}  // namespace stillpoint::synth
