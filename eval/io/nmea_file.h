// SPDX-License-Identifier: BSD-3-Clause
/// Positions of a GNSS receiver in a local plane, from NMEA 0183 sentences.
#pragma once

#include <string_view>

#include <Eigen/Core>

#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

/// Name of the body frame of trajectories from GNSS. Their world has x east, y north, z up and its origin at
/// the first position; their orientations are unknown and stored as identity.
inline constexpr const char* kGnssFrame = "gnss_antenna";

/// A position on the WGS84 ellipsoid.
struct GeodeticPosition {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double height_m = 0.0;  ///< above the ellipsoid
};

/// Earth-centered, earth-fixed coordinates [m] (WGS84: a = 6378137 m, 1/f = 298.257223563).
[[nodiscard]] Eigen::Vector3d ecef(const GeodeticPosition& position);

/// East, north and up [m] of `position` in the tangent plane at `origin`:
///   p_enu = R(origin) (ecef(position) - ecef(origin)), rows of R: east, north, up.
[[nodiscard]] Eigen::Vector3d east_north_up(const GeodeticPosition& position, const GeodeticPosition& origin);

/// Reads GGA (position, height above the geoid and separation of the geoid) and valid RMC (date) of any
/// talker. Other sentences, positions without a fix, and sentences with a wrong checksum are skipped and
/// counted. Stamps are UTC seconds since 1970 without leap seconds.
/// @param text sentences, one per line
/// @param name of the text in messages
/// @throws InputError if there is no position, or no date
[[nodiscard]] LoadedTrajectory parse_nmea(std::string_view text, const std::string& name);

/// Whether one of the first 20 lines begins with "$" and five capital letters or digits, as a NMEA sentence.
/// A log may start within a sentence.
[[nodiscard]] bool is_nmea(std::string_view text);

}  // namespace stillpoint::eval
