// SPDX-License-Identifier: BSD-3-Clause
/// Changes of numbers that people have looked at and accept, with their reasons.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/store/database.h"

namespace stillpoint {

/// A metric is allowed to have changed at a commit; an empty variant or sequence stands for all.
struct Acceptance {
  std::string commit;
  std::string metric;  ///< name of a metric or of a module
  std::string variant;
  std::string sequence;
  std::string reason;
  std::string accepted;  ///< UTC, ISO 8601
};

/// In the order of commit, metric, variant and sequence. A store of an older schema has none.
[[nodiscard]] std::vector<Acceptance> read_acceptances(const Database& database);

/// Adds acceptances to a store; one of the same commit, metric, variant and sequence is replaced. The store
/// is brought up to date if need be.
/// @throws InputError if there is no such store, or it cannot be written
void write_acceptances(const std::filesystem::path& file, const std::vector<Acceptance>& acceptances);

/// Takes an acceptance back; its reason and time do not matter. @return false if there was none
[[nodiscard]] bool withdraw_acceptance(const std::filesystem::path& file, const Acceptance& acceptance);

}  // namespace stillpoint
