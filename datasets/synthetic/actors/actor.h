// SPDX-License-Identifier: BSD-3-Clause
/// Moving objects of a scene: rigid parts whose poses are functions of time.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "datasets/io/sequence_info.h"
#include "datasets/synthetic/actors/rigid_part.h"
#include "datasets/synthetic/render/frame_renderer.h"

namespace stillpoint::synth {

struct Actor {
  int object = 1;                     ///< instance number in the labels
  std::string class_name = "person";  ///< as in true_boxes.txt
  std::vector<RigidPart> parts;
  std::function<std::vector<Pose>(double t_s)> poses_at;  ///< T_w_part of each part; thread-safe
};

/// Merges the parts of all actors into one mesh with vertex positions at both ends of a time interval.
[[nodiscard]] MoverFrame assemble_movers(std::span<const Actor> actors, double start_s, double end_s);

}  // namespace stillpoint::synth
