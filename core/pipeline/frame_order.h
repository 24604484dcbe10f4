// SPDX-License-Identifier: BSD-3-Clause
/// Rejects frames that arrive out of order.
#pragma once

#include <optional>

#include "core/base/error.h"
#include "core/base/timestamp.h"

namespace stillpoint {

class FrameOrder {
 public:
  /// @throws InputError if `t` is earlier than the last accepted frame
  void check(Timestamp t) const {
    if (last_ && t < *last_) {
      throw InputError("frame at " + std::to_string(t.ns) + " ns", "is earlier than the previous frame (" +
                                                                       std::to_string(last_->ns) +
                                                                       " ns); add frames in temporal order");
    }
  }
  void accept(Timestamp t) { last_ = t; }

 private:
  std::optional<Timestamp> last_;
};

}  // namespace stillpoint
