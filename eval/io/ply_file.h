// SPDX-License-Identifier: BSD-3-Clause
/// Point clouds with colors in PLY files: binary little endian or ASCII, with the vertex properties x, y, z
/// and, optionally, red, green, blue. Further scalar properties are skipped, as are elements after the
/// vertices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace stillpoint::eval {

struct CloudPoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();  ///< [m]
  std::array<std::uint8_t, 3> rgb{};
};

/// The first bytes of each file that is written.
inline constexpr const char* kPlyMagic = "ply\n";

/// A binary file with the properties float x, y, z and uchar red, green, blue.
[[nodiscard]] std::string ply_bytes(const std::vector<CloudPoint>& cloud);

/// The same as text, in millimeters: valid UTF-8, as JSON requires.
[[nodiscard]] std::string ply_text(const std::vector<CloudPoint>& cloud);

/// Of a text; `place` is its name in error messages.
/// @throws InputError if it is no PLY file, has no points or lists in front of them, ends early, or contains
/// numbers that are not finite
[[nodiscard]] std::vector<CloudPoint> parse_ply(const std::string& text, const std::string& place);

/// @throws InputError if the file cannot be read, and as `parse_ply`
[[nodiscard]] std::vector<CloudPoint> read_ply(const std::filesystem::path& file);

/// One point of each cell of a grid: the first one. The side of the cells grows from 4 cm until at most
/// `max_points` are left, which is at least 8, the number of cells around the origin; a smaller cloud is not
/// changed.
[[nodiscard]] std::vector<CloudPoint> thinned_cloud(const std::vector<CloudPoint>& cloud,
                                                    std::size_t max_points);

}  // namespace stillpoint::eval
