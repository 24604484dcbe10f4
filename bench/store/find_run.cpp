// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/find_run.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.h"

namespace stillpoint::bench {

StoredRun find_run(const Store& store, const std::string& key) {
  constexpr std::size_t kListedCandidates = 5;
  std::vector<StoredRun> found = store.run_headers();
  std::erase_if(found, [&](const StoredRun& run) { return !run.key.starts_with(key); });
  if (found.size() == 1) return store.with_details(std::move(found)).front();
  if (found.size() > 1) {
    std::vector<std::string> candidates;
    for (const StoredRun& run : std::span(found).first(std::min(found.size(), kListedCandidates)))
      candidates.push_back(fmt::format("{} ({} {})", run.key, run.identity.sequence, run.identity.variant));
    throw InputError("run \"" + key + "\"", fmt::format("is the beginning of {} keys; use a longer one: {}{}",
                                                        found.size(), fmt::join(candidates, ", "),
                                                        found.size() > kListedCandidates ? ", ..." : ""));
  }
  throw InputError("run \"" + key + "\"",
                   "not found in " + store.file().string() + "; see `stillpoint store list`");
}

}  // namespace stillpoint::bench
