// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/world.h"

#include <cmath>
#include <numbers>

namespace stillpoint {

using Eigen::Vector3d;

int Builder::add_texture(const cv::Mat& picture) {
  world_.textures.emplace_back(picture);
  return static_cast<int>(world_.textures.size()) - 1;
}

void Builder::set_frame(const Vector3d& position, double yaw) {
  T_w_local_ = Pose{Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())), position};
}

Vector3d Builder::to_world(const Vector3d& point) const { return T_w_local_ * point; }

Vector3d Builder::turn(const Vector3d& vector) const { return T_w_local_.q * vector; }

void Builder::add_picture(const Vector3d& corner, const Vector3d& right, const Vector3d& down, int texture,
                          const PictureArea& area) {
  const Texture& picture = world_.textures[static_cast<std::size_t>(texture)];
  const double texels = area.width * picture.width() * area.height * picture.height();
  // right x up points to the viewer: start at the lower left corner and let v grow upwards.
  Quad quad;
  quad.origin = to_world(corner + down).cast<float>();
  quad.edge_u = turn(right).cast<float>();
  quad.edge_v = turn(-down).cast<float>();
  quad.normal = quad.edge_u.cross(quad.edge_v).normalized();
  quad.texture = texture;
  quad.s = static_cast<float>(area.s);
  quad.t = static_cast<float>(area.t + area.height);
  quad.s_per_u = static_cast<float>(area.width);
  quad.t_per_v = static_cast<float>(-area.height);
  quad.texels_per_m = static_cast<float>(std::sqrt(texels / (right.norm() * down.norm())));
  world_.quads.push_back(quad);
}

void Builder::add_surface(const Vector3d& corner, const Vector3d& right, const Vector3d& down, int texture,
                          double metres) {
  // The start in the picture depends on the place, so that equal surfaces do not look equal.
  const double s = std::fmod(std::abs(3.17 * corner.x() + 1.31 * corner.y() + 0.77 * corner.z()), 1.0);
  add_picture(corner, right, down, texture, {s, 0.61 * s, right.norm() / metres, down.norm() / metres});
}

void Builder::add_box(const Vector3d& low, const Vector3d& high, int texture, double metres) {
  const Vector3d size = high - low;
  const Vector3d x(size.x(), 0.0, 0.0), y(0.0, size.y(), 0.0), z(0.0, 0.0, size.z());
  add_surface(low + z, x, -z, texture, metres);           // front, towards -y
  add_surface(low + x + y + z, -x, -z, texture, metres);  // back
  add_surface(low + y + z, -y, -z, texture, metres);      // left
  add_surface(low + x + z, y, -z, texture, metres);       // right
  add_surface(low + y + z, x, -y, texture, metres);       // top
  add_surface(low, x, y, texture, metres);                // bottom
}

void Builder::add_labelled_box(const Vector3d& low, const Vector3d& high, int front_texture,
                               const PictureArea& area, int side_texture) {
  const Vector3d size = high - low;
  const Vector3d x(size.x(), 0.0, 0.0), y(0.0, size.y(), 0.0), z(0.0, 0.0, size.z());
  constexpr double kMetres = 0.5;
  add_picture(low + z, x, -z, front_texture, area);
  add_surface(low + x + y + z, -x, -z, side_texture, kMetres);
  add_surface(low + y + z, -y, -z, side_texture, kMetres);
  add_surface(low + x + z, y, -z, side_texture, kMetres);
  add_surface(low + y + z, x, -y, side_texture, kMetres);
}

void Builder::add_cylinder(const Vector3d& base, double radius, double height, int texture, double metres,
                           int sides) {
  const Vector3d up(0.0, 0.0, height);
  const auto rim = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    return Vector3d(base + radius * Vector3d(std::cos(angle), std::sin(angle), 0.0));
  };
  for (int i = 0; i < sides; ++i) {
    const double s = 2.0 * std::numbers::pi * radius * i / sides / metres;
    const Vector3d side = rim(i + 1) - rim(i);
    add_picture(rim(i) + up, side, -up, texture, {s, 0.0, side.norm() / metres, height / metres});
  }
  // The lid: three rhombi make a regular hexagon, which leaves only slivers below the rim.
  const Vector3d center = base + up;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 3.0;
    const Vector3d first = radius * Vector3d(std::cos(angle), std::sin(angle), 0.0);
    const Vector3d second = Eigen::AngleAxisd(2.0 * std::numbers::pi / 3.0, Vector3d::UnitZ()) * first;
    add_surface(center + second, first, -second, texture, metres);
  }
}

void Builder::add_lamp(const Vector3d& center, double size_x, double size_y, double power, int texture) {
  Lamp lamp;
  lamp.center = to_world(center).cast<float>();
  lamp.half_x = static_cast<float>(0.5 * size_x);
  lamp.half_y = static_cast<float>(0.5 * size_y);
  lamp.power = static_cast<float>(power);
  world_.lamps.push_back(lamp);
  const Vector3d x(size_x, 0.0, 0.0), y(0.0, size_y, 0.0);
  add_picture(center - 0.5 * x - 0.5 * y, x, y, texture);
  make_last_shine();
}

}  // namespace stillpoint
