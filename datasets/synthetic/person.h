// SPDX-License-Identifier: BSD-3-Clause
/// People: a jointed body with gait, clothes, and small movements when seated.
#pragma once

#include "datasets/synthetic/actor.h"
#include "datasets/synthetic/furniture.h"
#include "datasets/synthetic/walk.h"

namespace stillpoint {

/// Somebody who walks. @param object instance number
[[nodiscard]] Actor make_walker(Builder& builder, int object, const Walk& walk, std::uint64_t random_key);

/// Somebody who sits on a chair at `seat` (looking towards its front) and moves arms, trunk and head a
/// little.
[[nodiscard]] Actor make_sitter(Builder& builder, int object, const Place& seat, std::uint64_t random_key);

}  // namespace stillpoint
