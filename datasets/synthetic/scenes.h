// SPDX-License-Identifier: BSD-3-Clause
/// The places of the synthetic world.
#pragma once

#include <cstdint>

#include "datasets/synthetic/furniture.h"
#include "datasets/synthetic/hand_motion.h"
#include "datasets/synthetic/world.h"

namespace stillpoint {

enum class SceneKind { kOffice, kMarket, kCorridor, kHall };

/// A place with its light baked, and what happens in it.
struct Scene {
  World world;
  Room room;
  Viewpoint viewpoint;  ///< of a hand-held camera
  double gain = 1.0;    ///< from the scene's light to the sensor's range
};

/// Furnished office of 8 x 7 m with four desks, as in the TUM freiburg3 sequences.
[[nodiscard]] Scene build_office(std::uint64_t seed);

}  // namespace stillpoint
