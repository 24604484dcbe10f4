// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/sequence_source.h"

#include <algorithm>

#include "bench/config/spelling.h"
#include "bench/run/rendered_sequence.h"
#include "core/base/error.h"

namespace stillpoint::bench {

std::unique_ptr<datasets::SensorStream> find_sequence(const std::string& name,
                                                      const datasets::OpenOptions& options,
                                                      const synth::RenderControl& control) {
  if (datasets::is_sequence_path(name)) return datasets::open_sequence(name, options);
  const std::vector<std::string> presets = synth::preset_names();
  if (std::find(presets.begin(), presets.end(), name) == presets.end()) {
    throw InputError("sequence \"" + name + "\"",
                     "is neither a folder nor a preset" + suggestion(name, presets));
  }
  const std::filesystem::path folder =
      rendered_sequence(synth::preset_request(name), control, options.frame_cache);
  return folder.empty() ? nullptr : datasets::open_sequence(folder, options);
}

}  // namespace stillpoint::bench
