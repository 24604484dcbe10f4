// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process/temporary_path.h"

#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "core/base/error.h"

namespace stillpoint::bench {

TemporaryPath::TemporaryPath(Kind kind, const std::string& purpose) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) {
    const char* const set = std::getenv("TMPDIR");
    throw InputError(set == nullptr ? "TMPDIR" : "TMPDIR=" + std::string(set),
                     "is no folder for temporary files; set it to one");
  }
  std::string name = (folder / ("stillpoint-" + purpose + "-XXXXXX")).string();
  bool is_created = false;
  if (kind == Kind::kFolder) {
    is_created = mkdtemp(name.data()) != nullptr;
  } else if (const int file = mkstemp(name.data()); file >= 0) {
    is_created = true;
    close(file);
  }
  if (!is_created)
    throw InputError(name, std::string("cannot be created: ") + std::strerror(errno) + "; set TMPDIR");
  path_ = name;
}

TemporaryPath::~TemporaryPath() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace stillpoint::bench
