// SPDX-License-Identifier: BSD-3-Clause
/// Recovery of the readable content of a damaged store.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace stillpoint::bench {

struct SalvageReport {
  std::map<std::string, std::size_t> saved;  ///< rows by table, and "file": attached files
  std::vector<std::string> losses;           ///< one line each; empty if everything was readable
};

/// Copies what is readable of a damaged store into a new one, row by row: completed runs with their metrics,
/// times, files and manifests; plans; acceptances. `from` is not changed. Identities and files are verified
/// by their hashes; altered numbers in otherwise valid rows cannot be noticed. A saved run of which rows are
/// lost has a detail that says so.
/// @param into must not exist
/// @throws InputError if `into` exists or cannot be written, or if nothing of `from` is readable
SalvageReport salvage_store(const std::filesystem::path& from, const std::filesystem::path& into);

}  // namespace stillpoint::bench
