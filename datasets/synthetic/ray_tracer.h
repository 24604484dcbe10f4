// SPDX-License-Identifier: BSD-3-Clause
/// Rays against the world, eight at a time. The only file pair that knows Embree (Wald et al. 2014).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "datasets/synthetic/world.h"

namespace stillpoint {

inline constexpr int kPacket = 8;

/// Eight rays and what they met. A lane with `far` < 0 is off.
struct RayPacket {
  alignas(32) float origin_x[kPacket], origin_y[kPacket], origin_z[kPacket];
  alignas(32) float direction_x[kPacket], direction_y[kPacket], direction_z[kPacket];
  alignas(32) float time[kPacket];  ///< in [0, 1] between the two vertex sets of moving geometry
  alignas(
      32) float far[kPacket];  ///< in: how far to look; out: distance to the hit, in lengths of the direction
  alignas(32) float u[kPacket], v[kPacket];
  alignas(32) std::int32_t primitive[kPacket];  ///< -1: nothing was met
  bool moving[kPacket];                         ///< the primitive is one of the moving mesh, not of the world
};

/// A mesh of triangles at the two ends of a short span of time, between which vertices move straight.
struct MovingMesh {
  std::vector<Eigen::Vector3f> start;  ///< at ray time 0
  std::vector<Eigen::Vector3f> end;    ///< at ray time 1, as many
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Acceleration structures of a world; built by one thread, so that ties between surfaces always fall the
/// same way. Tracing is safe from several threads at once.
class RayTracer {
 public:
  explicit RayTracer(const World& world);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;

  /// Nearest hits of the standing world.
  void trace(RayPacket& packet) const;

  /// Whether nothing stands between `from` and `to`, both a little off any surface.
  [[nodiscard]] bool sees(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

  /// The moving mesh of one frame, and its own structure.
  class Movers {
   public:
    Movers(const RayTracer& tracer, const MovingMesh& mesh);
    ~Movers();
    Movers(Movers&&) noexcept;

    /// Takes hits nearer than those that `packet` already has.
    void trace(RayPacket& packet) const;

   private:
    struct Scene;
    std::unique_ptr<Scene> scene_;
  };

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace stillpoint
