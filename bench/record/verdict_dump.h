// SPDX-License-Identifier: BSD-3-Clause
/// Every verdict on every feature, for people who want to know why.
#pragma once

#include <string>

#include "core/pipeline/runner.h"

namespace stillpoint {

/// Rows of verdicts.csv, one a feature of a picture that entered the window.
class VerdictDump {
 public:
  void add(const PictureReport& report);

  /// The file: a line of names, then `frame,t,id,u_px,v_px,depth_m,age,verdict,reason,residual_px`; depth 0
  /// is not measured, an empty residual was not evaluated.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_ = "frame,t,id,u_px,v_px,depth_m,age,verdict,reason,residual_px\n";
};

}  // namespace stillpoint
