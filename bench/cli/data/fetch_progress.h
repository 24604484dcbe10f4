// SPDX-License-Identifier: BSD-3-Clause
/// Console output while sequences are fetched.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/fetch/fetch_sequences.h"

namespace stillpoint::bench {

class ByteProgress;

/// Displays one progress line per step: size, rate and remaining time. Stops at SIGINT and SIGTERM.
class FetchProgress {
 public:
  FetchProgress();
  ~FetchProgress();
  FetchProgress(const FetchProgress&) = delete;
  FetchProgress& operator=(const FetchProgress&) = delete;

  /// Valid as long as this object.
  [[nodiscard]] FetchControl control();

 private:
  std::unique_ptr<ByteProgress> line_;
};

/// Prints each licence that has not been accepted, and records its acceptance.
/// @param accepted_by_option else the user is asked on a terminal
/// @throws InputError if it is not accepted
void accept_licences(const std::vector<datasets::CatalogueEntry>& entries, const std::filesystem::path& root,
                     bool accepted_by_option);

}  // namespace stillpoint::bench
