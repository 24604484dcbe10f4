// SPDX-License-Identifier: BSD-3-Clause
/// Detection of a depth sensor whose scale has changed.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/window/window.h"

namespace stillpoint {

/// Compares the depths d_k measured in the newest frame with the depths z_k of the same static landmarks at
/// its predicted pose, as known from earlier frames. The scale is the median of d_k / (s z_k) with the
/// estimated depth scale s of the window, if at least 15 landmarks are compared and half of the ratios are
/// within 2 % of it.
class DepthScale {
 public:
  /// @return nullopt without a common scale
  [[nodiscard]] std::optional<double> of_newest(const Window& window);

 private:
  std::vector<double> ratios_;  ///< buffer of `of_newest`
};

}  // namespace stillpoint
