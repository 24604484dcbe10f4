// SPDX-License-Identifier: BSD-3-Clause
/// How sequences of the catalogue are fetched.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "datasets/download/archive_extraction.h"
#include "datasets/download/transfer_control.h"

namespace stillpoint::bench {

struct FetchOptions {
  std::filesystem::path root;  ///< sequences are stored in ROOT/DATASET/FOLDER
  std::string mirror;          ///< address that serves MIRROR/DATASET/FILE, tried first; empty = none
  bool keep_archives = false;
  int attempts = 5;  ///< per address
  double first_backoff_s = 1.0;
  int stall_timeout_s = 30;
  datasets::ExtractionLimits limits;
  bool record_boxes = false;  ///< fetch a detection network, and record the boxes of sequences without any
};

/// How the progress of a step is displayed and the whole operation is stopped.
struct FetchControl {
  /// @param label what is done with which file, e.g. "downloading a.tgz"
  std::function<datasets::TransferControl(const std::string& label)> step;
  std::function<void(const std::string&)> report;  ///< one line about something that is complete
};

}  // namespace stillpoint::bench
