// SPDX-License-Identifier: BSD-3-Clause
/// The message of the InputError that an action throws.
#pragma once

#include <functional>
#include <string>

#include "core/base/error.h"

namespace stillpoint {

/// Empty if nothing was thrown.
inline std::string thrown_message(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace stillpoint
