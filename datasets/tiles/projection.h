// SPDX-License-Identifier: BSD-3-Clause
/// PROJ behind a function pointer, in a module of its own (datasets/io/shared_module.h): the plane of a
/// coordinate reference system (CRS) to Web Mercator.
#pragma once

#include <string>
#include <vector>

namespace stillpoint::datasets {

/// A place in a plane [m]: x to the right, y up.
struct PlanePoint {
  double x = 0.0;
  double y = 0.0;
};

struct ProjectedPoints {
  std::vector<PlanePoint> points;
  std::string problem;  ///< why there are no points, and the remedy; empty if there are
};

struct ProjectionModule {
  /// From x east and y north [m] of a CRS to Web Mercator (EPSG:3857): X = R lon, Y = R ln tan(pi/4 + lat/2),
  /// R = 6378137 m. Grids of datum shifts are not downloaded.
  /// @param crs a projected CRS in meters: a code of an authority, a PROJ string or WKT
  /// @param points may be empty: the CRS alone is checked
  ProjectedPoints (*to_web_mercator)(const std::string& crs, std::vector<PlanePoint> points);
};

/// The module, loaded at the first call.
/// @throws InputError naming the package if this build has none
[[nodiscard]] const ProjectionModule& projection_module();

}  // namespace stillpoint::datasets
