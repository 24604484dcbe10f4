// SPDX-License-Identifier: BSD-3-Clause
/// Trial of a described system: whether it runs on a short rendered sequence, and whether what it writes
/// follows the conventions that its description states.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "bench/systems/external_system.h"

namespace stillpoint::bench {

struct CheckOptions {
  std::filesystem::path folder;  ///< receives the output of the program in "out", and program.log
  double time_limit_s = 60.0;
  int memory_limit_mb = 4096;
};

struct SystemCheck {
  std::string finding;  ///< the first thing that is wrong, and its remedy: one line; empty if nothing is
  std::string summary;  ///< one line, without a finding
};

/// Executes the system on 3 s of a rendered static scene (640x480, 30 images and 400 inertial samples per
/// second; axes of the body: x forward, y left, z up), without a display and with limits of time, memory
/// (with that of its children) and output.
///
/// Found in this order: the program does not exist; does not end; exceeds a limit; needs a display; fails;
/// changes files outside of {out} (of the sequence, beside the description or beside {out}; directly in the
/// home folder, the temporary folder or the current one, if it does so twice); writes no trajectory, half a
/// line, values that are not finite, or another format; a convention (stamps, scale, inverse, frame, order of
/// quaternions); no relation to the true motion; poses for less than half of the images.
/// @throws InputError if the sequence cannot be rendered or exported
[[nodiscard]] SystemCheck check_system(const ExternalSystem& system, const CheckOptions& options);

}  // namespace stillpoint::bench
