// SPDX-License-Identifier: BSD-3-Clause
/// Console output while sequences are fetched.
#pragma once

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

enum class LicenceAnswer {
  kAccepted,  ///< by an option of the command
  kAsk,       ///< on a terminal
};

/// The sequences of a plan that the catalogue has.
/// @throws InputError as `load_plan`
[[nodiscard]] std::vector<datasets::CatalogueEntry> plan_entries(
    const std::string& plan, const std::vector<datasets::CatalogueDataset>& catalogues);

/// Prints licences that have not been accepted, and what is missing; then fetches it.
/// @throws InputError if a licence is not accepted, and as `fetch_sequences`
[[nodiscard]] FetchResult fetch_with_progress(const std::vector<datasets::CatalogueEntry>& entries,
                                              FetchOptions options, LicenceAnswer licence);

}  // namespace stillpoint::bench
