// SPDX-License-Identifier: BSD-3-Clause
/// Asserts that invalid input is rejected with a message that contains given parts.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/error.h"

namespace stillpoint {

/// Runs `action`, which must throw an InputError whose message contains all of `parts`.
template <class Action>
void expect_input_error(const Action& action, const std::vector<std::string>& parts) {
  try {
    action();
  } catch (const InputError& error) {
    for (const std::string& part : parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << "\"" << part << "\" is not in: " << error.what();
    }
    return;
  }
  ADD_FAILURE() << "no InputError was thrown";
}

}  // namespace stillpoint
