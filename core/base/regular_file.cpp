// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/regular_file.h"

#include <string>

#include "core/base/error.h"

namespace stillpoint {

void require_regular_file(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  const auto reject = [&](const std::string& kind) {
    throw InputError(file.string(), "is a " + kind + "; expected a file");
  };
  std::error_code error;
  switch (fs::status(file, error).type()) {
    case fs::file_type::directory:
      return reject("folder");
    case fs::file_type::fifo:
      return reject("pipe");
    case fs::file_type::socket:
      return reject("socket");
    case fs::file_type::block:
    case fs::file_type::character:
      return reject("device");
    default:
      return;
  }
}

}  // namespace stillpoint
