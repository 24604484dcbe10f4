// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence/sequence_cache.h"

#include <cstdlib>

#include "core/base/error.h"
#include "datasets/synthetic/sequence/request_text.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

fs::path variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? fs::path{} : fs::path(value);
}

}  // namespace

fs::path cache_folder() {
  if (const fs::path own = variable("STILLPOINT_CACHE"); !own.empty()) return own;
  if (const fs::path users = variable("XDG_CACHE_HOME"); !users.empty()) return users / "stillpoint";
  if (const fs::path home = variable("HOME"); !home.empty()) return home / ".cache" / "stillpoint";
  throw InputError("STILLPOINT_CACHE",
                   "is not set, and neither is HOME; set it to the folder for rendered sequences");
}

fs::path cached_sequence(const SynthRequest& request, const RenderControl& control) {
  check_request(request);
  // The last path component is the name shown in tables: preset and seed. The key is the parent folder.
  const std::string name = request.preset + "_" + std::to_string(request.seed);
  const fs::path folder = cache_folder() / "synthetic" / request_key(request) / name;
  if (fs::exists(folder / "detections.txt")) return folder;
  fs::remove_all(folder);  // static scenes that were rendered before version 0.3 have no boxes
  try {
    if (!render_sequence(request, folder, control)) return {};
  } catch (const InputError&) {
    if (!fs::is_directory(folder)) throw;  // rendered concurrently by another process: identical result
  }
  return folder;
}

}  // namespace stillpoint::synth
