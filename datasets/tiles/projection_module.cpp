// SPDX-License-Identifier: BSD-3-Clause
/// Source of libstillpoint_projection.so. It is linked with no other source of the project.
#include <proj.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "datasets/tiles/projection.h"

namespace stillpoint::datasets {
namespace {

using Context = std::unique_ptr<PJ_CONTEXT, decltype(&proj_context_destroy)>;
using Object = std::unique_ptr<PJ, decltype(&proj_destroy)>;

Object object(PJ* pointer) { return {pointer, &proj_destroy}; }

/// The CRS of the plane: without a datum shift, and without heights.
Object plane_of(PJ_CONTEXT* context, Object crs) {
  if (proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS)
    crs = object(proj_crs_get_sub_crs(context, crs.get(), 0));
  if (proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS) crs = object(proj_get_source_crs(context, crs.get()));
  return crs;
}

bool is_plane_in_meters(PJ_CONTEXT* context, const PJ* crs) {
  const Object plane = plane_of(context, object(proj_clone(context, crs)));
  if (proj_get_type(plane.get()) != PJ_TYPE_PROJECTED_CRS) return false;
  const Object axes = object(proj_crs_get_coordinate_system(context, plane.get()));
  double meters = 0.0;
  return proj_cs_get_axis_info(context, axes.get(), 0, nullptr, nullptr, nullptr, &meters, nullptr, nullptr,
                               nullptr) != 0 &&
         meters == 1.0;
}

/// Longitude and latitude [deg] of a place in Web Mercator.
PlanePoint degrees_of(const PlanePoint& mercator) {
  constexpr double kRadius_m = 6378137.0;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  return {kDegrees * mercator.x / kRadius_m, kDegrees * std::atan(std::sinh(mercator.y / kRadius_m))};
}

/// What is wrong if the area in which the CRS is used is known and has none of the points.
std::string area_problem(PJ_CONTEXT* context, const PJ* crs, const std::vector<PlanePoint>& mercator) {
  double west = 0.0;
  double south = 0.0;
  double east = 0.0;
  double north = 0.0;
  constexpr double kUnknown = -1000.0;  // of PROJ
  if (proj_get_area_of_use(context, crs, &west, &south, &east, &north, nullptr) == 0 || west == kUnknown)
    return "";
  const bool is_used = std::ranges::any_of(mercator, [&](const PlanePoint& point) {
    const auto [longitude, latitude] = degrees_of(point);
    const bool is_between = west <= east ? longitude >= west && longitude <= east
                                         : longitude >= west || longitude <= east;  // across 180 deg
    return is_between && latitude >= south && latitude <= north;
  });
  if (is_used || mercator.empty()) return "";
  const PlanePoint first = degrees_of(mercator.front());
  return fmt::format(
      "has the trajectory at latitude {:.4f} and longitude {:.4f} deg, but is for latitudes from {:g} to "
      "{:g} and longitudes from {:g} to {:g} deg only",
      first.y, first.x, south, north, west, east);
}

ProjectedPoints refused(const std::string& problem) {
  return {{}, problem + "; it must be that of the ground truth, whose x is east and y north [m]"};
}

ProjectedPoints to_web_mercator(const std::string& crs, std::vector<PlanePoint> points) {
  const Context context(proj_context_create(), &proj_context_destroy);
  proj_log_func(context.get(), nullptr, [](void*, int, const char*) {});
  proj_context_set_enable_network(context.get(), 0);
  const Object target = object(proj_create(context.get(), "EPSG:3857"));
  if (target == nullptr)
    return {{}, "cannot be used: PROJ does not find its database proj.db (Debian: proj-data); set PROJ_DATA"};
  const bool is_bare_string =
      crs.find("+proj") != std::string::npos && crs.find("+type") == std::string::npos;
  const Object source =
      object(proj_create(context.get(), (is_bare_string ? crs + " +type=crs" : crs).c_str()));
  if (source == nullptr || proj_is_crs(source.get()) == 0) return refused("is no CRS that PROJ knows");
  if (!is_plane_in_meters(context.get(), source.get())) return refused("is no plane in meters");
  Object there =
      object(proj_create_crs_to_crs_from_pj(context.get(), source.get(), target.get(), nullptr, nullptr));
  if (there != nullptr) there = object(proj_normalize_for_visualization(context.get(), there.get()));
  if (there == nullptr) return refused("cannot be converted to Web Mercator (EPSG:3857) by PROJ");
  for (PlanePoint& point : points) {
    const PJ_COORD at = proj_trans(there.get(), PJ_FWD, proj_coord(point.x, point.y, 0.0, HUGE_VAL));
    const PJ_COORD back = proj_trans(there.get(), PJ_INV, at);
    // Beyond the ends of a projection there is none, or one that belongs to another place of the plane.
    constexpr double kSamePlace_m = 1.0;
    if (!(std::hypot(back.xy.x - point.x, back.xy.y - point.y) < kSamePlace_m)) {
      return refused(fmt::format("has no place at x = {:.1f} m and y = {:.1f} m, near the trajectory",
                                 point.x, point.y));
    }
    point = {at.xy.x, at.xy.y};
  }
  const std::string problem = area_problem(context.get(), source.get(), points);
  return problem.empty() ? ProjectedPoints{std::move(points), ""} : refused(problem);
}

}  // namespace

extern "C" const ProjectionModule stillpoint_projection_module;
const ProjectionModule stillpoint_projection_module = {.to_web_mercator = to_web_mercator};

}  // namespace stillpoint::datasets
