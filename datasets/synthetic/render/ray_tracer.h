// SPDX-License-Identifier: BSD-3-Clause
/// Ray queries in packets of eight. Only this component depends on Embree (Wald et al. 2014).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

inline constexpr int kPacket = 8;

/// Eight rays and their hits. Lanes with `far` < 0 are inactive.
struct RayPacket {
  alignas(32) float origin_x[kPacket], origin_y[kPacket], origin_z[kPacket];
  alignas(32) float direction_x[kPacket], direction_y[kPacket], direction_z[kPacket];
  alignas(32) float time[kPacket];  ///< in [0, 1] between the two vertex sets of moving geometry
  alignas(32) float far[kPacket];   ///< in: maximum distance; out: distance to the hit; in units of the
                                    ///< direction's length
  alignas(32) float u[kPacket], v[kPacket];
  alignas(32) std::int32_t primitive[kPacket];  ///< -1: no hit; in the world, triangles of its mesh follow
                                                ///< the quads
  bool moving[kPacket];  ///< the primitive belongs to the moving mesh, not to the world
};

/// A triangle mesh at both ends of a short time interval; vertices move linearly in between.
struct MovingMesh {
  std::vector<Eigen::Vector3f> start;  ///< at ray time 0
  std::vector<Eigen::Vector3f> end;    ///< at ray time 1, same size
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Acceleration structures of a world; built by one thread, so that hits on coincident surfaces are
/// deterministic. Tracing is thread-safe.
class RayTracer {
 public:
  explicit RayTracer(const World& world);
  ~RayTracer();
  RayTracer(RayTracer&&) noexcept;

  /// Nearest hits of the static world.
  void trace(RayPacket& packet) const;

  /// Whether the segment between `from` and `to` does not intersect the static world.
  [[nodiscard]] bool is_unoccluded(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

  /// Acceleration structure of the moving mesh of one frame.
  class Movers {
   public:
    Movers(const RayTracer& tracer, const MovingMesh& mesh);
    ~Movers();
    Movers(Movers&&) noexcept;

    /// Replaces hits in `packet` by closer ones.
    void trace(RayPacket& packet) const;

   private:
    struct Scene;
    std::unique_ptr<Scene> scene_;
  };

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace stillpoint::synth
