// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/error.h"

namespace stillpoint {

void check_failed(const char* condition, const char* file, int line) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": internal error: " + condition +
                         " does not hold; please report it");
}

}  // namespace stillpoint
