// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/render/world.h"

#include <cmath>
#include <numbers>
#include <span>

namespace stillpoint::synth {

using Eigen::Vector3d;

int Builder::add_texture(const cv::Mat& rgb) {
  world_.textures.emplace_back(rgb);
  return static_cast<int>(world_.textures.size()) - 1;
}

void Builder::set_frame(const Vector3d& position, double yaw) {
  T_w_local_ = Pose{Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())), position};
}

Vector3d Builder::to_world(const Vector3d& point) const { return T_w_local_ * point; }

Vector3d Builder::rotate(const Vector3d& vector) const { return T_w_local_.q * vector; }

void Builder::add_textured_quad(const Parallelogram& area, int texture, const TextureRegion& region) {
  const auto& [corner, right, down] = area;
  const Texture& image = world_.textures[static_cast<std::size_t>(texture)];
  const double texels = region.width * image.width() * region.height * image.height();
  // right x up points to the viewer: the origin is the lower left corner and v grows upwards.
  Quad quad;
  quad.origin = to_world(corner + down).cast<float>();
  quad.edge_u = rotate(right).cast<float>();
  quad.edge_v = rotate(-down).cast<float>();
  quad.normal = quad.edge_u.cross(quad.edge_v).normalized();
  quad.texture = texture;
  quad.s = static_cast<float>(region.s);
  quad.t = static_cast<float>(region.t + region.height);
  quad.s_per_u = static_cast<float>(region.width);
  quad.t_per_v = static_cast<float>(-region.height);
  quad.texels_per_m = static_cast<float>(std::sqrt(texels / (right.norm() * down.norm())));
  world_.quads.push_back(quad);
}

void Builder::add_surface(const Parallelogram& area, int texture, double repeat_m) {
  const auto& [corner, right, down] = area;
  // The texture offset depends on the position, so that equal surfaces look different.
  const double s = std::fmod(std::abs(3.17 * corner.x() + 1.31 * corner.y() + 0.77 * corner.z()), 1.0);
  add_textured_quad(area, texture, {s, 0.61 * s, right.norm() / repeat_m, down.norm() / repeat_m});
}

void Builder::add_box(const Vector3d& low, const Vector3d& high, int texture, double repeat_m) {
  const Vector3d size = high - low;
  const Vector3d x(size.x(), 0.0, 0.0), y(0.0, size.y(), 0.0), z(0.0, 0.0, size.z());
  add_surface({low + z, x, -z}, texture, repeat_m);           // front, towards -y
  add_surface({low + x + y + z, -x, -z}, texture, repeat_m);  // back
  add_surface({low + y + z, -y, -z}, texture, repeat_m);      // left
  add_surface({low + x + z, y, -z}, texture, repeat_m);       // right
  add_surface({low + y + z, x, -y}, texture, repeat_m);       // top
  add_surface({low, x, y}, texture, repeat_m);                // bottom
  close_last(6);
}

void Builder::add_labeled_box(const Vector3d& low, const Vector3d& high, const Label& front,
                              int side_texture) {
  const Vector3d size = high - low;
  const Vector3d x(size.x(), 0.0, 0.0), y(0.0, size.y(), 0.0), z(0.0, 0.0, size.z());
  constexpr double kRepeat_m = 0.5;
  add_textured_quad({low + z, x, -z}, front.texture, front.region);
  add_surface({low + x + y + z, -x, -z}, side_texture, kRepeat_m);
  add_surface({low + y + z, -y, -z}, side_texture, kRepeat_m);
  add_surface({low + x + z, y, -z}, side_texture, kRepeat_m);
  add_surface({low + y + z, x, -y}, side_texture, kRepeat_m);
  close_last(5);  // by what it stands on
}

void Builder::close_last(std::size_t count) {
  for (Quad& quad : std::span(world_.quads).last(count)) quad.one_sided = true;
}

void Builder::add_cylinder(const Cylinder& cylinder, int texture, double repeat_m) {
  const auto& [base, radius, height, sides] = cylinder;
  const Vector3d up(0.0, 0.0, height);
  const auto rim = [&cylinder](int i) {
    const double angle = 2.0 * std::numbers::pi * i / cylinder.sides;
    return Vector3d(cylinder.base + cylinder.radius * Vector3d(std::cos(angle), std::sin(angle), 0.0));
  };
  for (int i = 0; i < sides; ++i) {
    const double s = 2.0 * std::numbers::pi * radius * i / sides / repeat_m;
    const Vector3d side = rim(i + 1) - rim(i);
    add_textured_quad({rim(i) + up, side, -up}, texture, {s, 0.0, side.norm() / repeat_m, height / repeat_m});
  }
  // The lid: three rhombi form a regular hexagon, which leaves only slivers open at the rim.
  const Vector3d center = base + up;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 3.0;
    const Vector3d first = radius * Vector3d(std::cos(angle), std::sin(angle), 0.0);
    const Vector3d second = Eigen::AngleAxisd(2.0 * std::numbers::pi / 3.0, Vector3d::UnitZ()) * first;
    add_surface({center + second, first, -second}, texture, repeat_m);
  }
}

void Builder::add_lamp(const Vector3d& center, const Eigen::Vector2d& size, double power, int texture) {
  Lamp lamp;
  lamp.center = to_world(center).cast<float>();
  lamp.half_x = static_cast<float>(0.5 * size.x());
  lamp.half_y = static_cast<float>(0.5 * size.y());
  lamp.power = static_cast<float>(power);
  world_.lamps.push_back(lamp);
  const Vector3d x(size.x(), 0.0, 0.0), y(0.0, size.y(), 0.0);
  add_textured_quad({center - 0.5 * x - 0.5 * y, x, y}, texture);
  mark_last_emissive();
}

}  // namespace stillpoint::synth
