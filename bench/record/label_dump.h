// SPDX-License-Identifier: BSD-3-Clause
/// Dynamic labels of all features with their reasons, as CSV.
#pragma once

#include <string>

#include "core/pipeline/runners/runner.h"

namespace stillpoint::bench {

/// Rows of labels.csv, one per feature of each frame that entered the window.
class LabelDump {
 public:
  void add(const FrameReport& report);

  /// CSV with the header `frame,t,id,u_px,v_px,depth_m,age,label,reason,residual_px`; depth 0: not measured,
  /// empty residual: not evaluated.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_ = "frame,t,id,u_px,v_px,depth_m,age,label,reason,residual_px\n";
};

}  // namespace stillpoint::bench
