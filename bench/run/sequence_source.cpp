// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/sequence_source.h"

#include <algorithm>

#include "bench/config/spelling.h"
#include "core/base/error.h"
#include "datasets/synthetic/sequence_cache.h"

namespace stillpoint {

std::unique_ptr<SensorStream> find_sequence(const std::string& name, const OpenOptions& options,
                                            const RenderControl& control) {
  if (std::filesystem::is_directory(name)) return open_sequence(name, options);
  const std::vector<std::string> presets = preset_names();
  if (std::find(presets.begin(), presets.end(), name) == presets.end()) {
    throw InputError("sequence \"" + name + "\"",
                     "is neither a folder nor a preset" + suggestion(name, presets));
  }
  const std::filesystem::path folder = cached_sequence(preset_request(name), control);
  return folder.empty() ? nullptr : open_sequence(folder, options);
}

}  // namespace stillpoint
