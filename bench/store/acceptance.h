// SPDX-License-Identifier: BSD-3-Clause
/// Reviewed and accepted changes of metrics, with their reasons.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/store/database.h"

namespace stillpoint::bench {

/// Accepts the change of a metric at a commit; an empty variant or sequence matches all.
struct Acceptance {
  std::string commit;
  std::string metric;  ///< name of a metric or of a module
  std::string variant;
  std::string sequence;
  std::string reason;
  std::string accepted;  ///< UTC, ISO 8601
};

/// Sorted by commit, metric, variant and sequence. A store of schema 1 has none.
[[nodiscard]] std::vector<Acceptance> read_acceptances(const Database& database);

/// Adds acceptances to a store; one of the same commit, metric, variant and sequence is replaced. An older
/// store is migrated.
/// @throws InputError if there is no such store, or it cannot be written
void write_acceptances(const std::filesystem::path& file, const std::vector<Acceptance>& acceptances);

/// Removes an acceptance; its reason and time are ignored. @return false if there was none
[[nodiscard]] bool withdraw_acceptance(const std::filesystem::path& file, const Acceptance& acceptance);

}  // namespace stillpoint::bench
