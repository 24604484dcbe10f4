// SPDX-License-Identifier: BSD-3-Clause
/// Everything that is needed to make a run again, and to know what its numbers may be compared with.
#pragma once

#include <string>

#include "bench/record/build_info.h"
#include "bench/record/host_info.h"
#include "core/pipeline/odometry_config.h"

namespace stillpoint {

struct RunManifest {
  std::string sequence;
  std::string sequence_format;
  std::string sequence_checksum;  ///< empty when the run was interrupted
  std::string base;
  std::string variant;
  OdometryConfig config;
  std::string mode;
  BuildInfo build;
  HostInfo host;
  std::string started;  ///< UTC, ISO 8601
};

}  // namespace stillpoint
