// SPDX-License-Identifier: BSD-3-Clause
/// TUM sequence folders without image files, for the replay system: fast to write and to read.
#pragma once

#include <cmath>
#include <string>

#include "tests/support/temporary_folder.h"

namespace stillpoint {

/// Writes the sequence `name` into the folder: 60 frames at 30 Hz along a curved path of about 2 m.
inline std::filesystem::path fake_sequence(const TemporaryFolder& folder, const std::string& name) {
  std::string color;
  std::string depth;
  std::string poses;
  for (int i = 0; i < 60; ++i) {
    const double t = 1000.0 + i / 30.0;
    const std::string stamp = std::to_string(t);
    color += stamp + " rgb/" + stamp + ".png\n";
    depth += stamp + " depth/" + stamp + ".png\n";
    poses += stamp + " " + std::to_string(std::cos(t)) + " " + std::to_string(std::sin(t)) + " 0 0 0 0 1\n";
  }
  folder.write(name + "/rgb.txt", color);
  folder.write(name + "/depth.txt", depth);
  folder.write(name + "/groundtruth.txt", poses);
  return folder.path() / name;
}

}  // namespace stillpoint
