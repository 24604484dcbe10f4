// SPDX-License-Identifier: BSD-3-Clause
/// Everything that is necessary to reproduce a run, and to decide which results are comparable with it.
#pragma once

#include <string>

#include "bench/record/build_info.h"
#include "bench/record/host_info.h"
#include "core/config/odometry_config.h"

namespace stillpoint::bench {

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

}  // namespace stillpoint::bench
