// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sequence_cache.h"

#include <cstdlib>

#include "core/base/error.h"
#include "datasets/synthetic/request_text.h"

namespace stillpoint {
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
  throw InputError("STILLPOINT_CACHE", "is not set, nor is HOME; name a folder for rendered sequences");
}

fs::path cached_sequence(const SynthRequest& request, const RenderControl& control) {
  check_request(request);
  // The last part is the sequence's name in tables: preset and seed first, the key apart in the folder above.
  const std::string name = request.preset + "_" + std::to_string(request.seed);
  const fs::path folder = cache_folder() / "synthetic" / request_key(request) / name;
  if (fs::is_directory(folder)) return folder;
  try {
    if (!render_sequence(request, folder, control)) return {};
  } catch (const InputError&) {
    if (!fs::is_directory(folder)) throw;  // another process was faster: its sequence is the same
  }
  return folder;
}

}  // namespace stillpoint
