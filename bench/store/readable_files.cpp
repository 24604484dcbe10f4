// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/readable_files.h"

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

bool is_readable(const Store& store, const StoredRun& run, const std::string& kind) {
  try {
    static_cast<void>(store.attachment(run, kind));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

ReadableRuns without_unreadable_files(const Store& store, std::vector<StoredRun> runs) {
  ReadableRuns result;
  for (StoredRun& run : runs) {
    std::string kinds;
    std::erase_if(run.blobs, [&](const auto& blob) {
      if (is_readable(store, run, blob.first)) return false;
      kinds += (kinds.empty() ? "" : ", ") + blob.first;
      return true;
    });
    if (kinds.empty()) continue;
    const std::string gap = "missing or damaged files: " + kinds;
    run.detail += (run.detail.empty() ? "" : "; ") + gap;
    result.gaps.push_back("run " + run.key + " (" + run.identity.sequence + ", " + run.identity.variant +
                          "): " + gap);
  }
  result.runs = std::move(runs);
  return result;
}

}  // namespace stillpoint::bench
