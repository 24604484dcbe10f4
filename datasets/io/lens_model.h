// SPDX-License-Identifier: BSD-3-Clause
/// The names by which programs call the distortion models of `Camera`.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.h"

namespace stillpoint::datasets {

/// The distortion of a calibration file or message, as it is written there.
struct NamedLens {
  std::string name;
  std::vector<double> coefficients;
};

/// `camera` with the model and coefficients of `lens`. Names, in any case:
///   radial-tangential, radtan, plumb_bob, pinhole, Brown Conrady, rational_polynomial: k1 k2 p1 p2 k3 k4 k5
///   k6 kannala-brandt, equidistant, equi, fisheye, KannalaBrandt8: k1 k2 k3 k4 none, or no name and no
///   coefficients: no distortion
/// Coefficients that are left out are 0. Further ones (thin prism, tilted sensor) must be 0.
/// @throws InputError that begins with `place` on another name, or too many coefficients
[[nodiscard]] Camera with_lens(Camera camera, const NamedLens& lens, const std::string& place);

}  // namespace stillpoint::datasets
