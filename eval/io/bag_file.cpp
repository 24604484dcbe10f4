// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/bag_file.h"

#include <algorithm>
#include <system_error>

namespace stillpoint::eval {
namespace {

namespace fs = std::filesystem;

bool has_bag_extension(const fs::path& path) {
  const fs::path extension = path.extension();
  return extension == ".bag" || extension == ".mcap" || extension == ".db3";
}

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return has_bag_extension(path);
  if (!fs::exists(path / "metadata.yaml", ignored)) return false;
  return std::any_of(fs::directory_iterator(path, ignored), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) {
                       return has_bag_extension(entry.path()) || has_bag_extension(entry.path().stem());
                     });
}

}  // namespace stillpoint::eval
