// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/lens_model.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <string_view>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr std::array<std::string_view, 10> kRadialNames = {"",
                                                           "none",
                                                           "radialtangential",
                                                           "radtan",
                                                           "plumbbob",
                                                           "pinhole",
                                                           "brownconrady",
                                                           "radtan8",
                                                           "rationalpolynomial",
                                                           "rational"};
constexpr std::array<std::string_view, 7> kFisheyeNames = {
    "kannalabrandt", "kannalabrandt4", "kannalabrandt8", "equidistant", "equi", "fisheye", "opencvfisheye"};

/// Lower case, without blanks, hyphens and underscores.
std::string plain(std::string_view name) {
  std::string result;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return result;
}

}  // namespace

Camera with_lens(Camera camera, const NamedLens& lens, const std::string& place) {
  const std::string name = plain(lens.name);
  const bool fisheye = std::ranges::find(kFisheyeNames, name) != kFisheyeNames.end();
  if (!fisheye && std::ranges::find(kRadialNames, name) == kRadialNames.end())
    throw InputError(place, "the distortion model \"" + lens.name +
                                "\" is not supported; calibrate the camera as plumb_bob (radtan), "
                                "rational_polynomial or equidistant, or undistort the images");
  const std::size_t limit = fisheye ? 4 : camera.distortion.size();
  const std::size_t used = std::min(limit, lens.coefficients.size());
  const auto rest = lens.coefficients.begin() + static_cast<std::ptrdiff_t>(used);
  if (std::any_of(rest, lens.coefficients.end(), [](double value) { return value != 0.0; }))
    throw InputError(place, "has more than " + std::to_string(limit) + " coefficients of distortion" +
                                (fisheye ? "" : ", those of a thin prism or a tilted sensor") +
                                "; calibrate the camera without them");
  camera.model = fisheye ? CameraModel::kKannalaBrandt : CameraModel::kRadialTangential;
  camera.distortion.fill(0.0);
  std::copy(lens.coefficients.begin(), rest, camera.distortion.begin());
  return camera;
}

}  // namespace stillpoint::datasets
