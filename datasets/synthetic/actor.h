// SPDX-License-Identifier: BSD-3-Clause
/// Things that move in a scene, as stiff parts whose poses are functions of time.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "datasets/sensor_stream.h"
#include "datasets/synthetic/frame_renderer.h"
#include "datasets/synthetic/rigid_part.h"

namespace stillpoint {

struct Actor {
  int object = 1;                     ///< instance number
  std::string class_name = "person";  ///< as in true_boxes.txt
  std::vector<RigidPart> parts;
  std::function<std::vector<Pose>(double t_s)>
      poses_at;  ///< T_w_part of each part; safe from several threads
};

/// The meshes of all actors between two moments, as the renderer wants them.
[[nodiscard]] MoverFrame assemble_movers(std::span<const Actor> actors, double start_s, double end_s);

}  // namespace stillpoint
