// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/sequence_source.h"

#include "core/base/error.h"

namespace stillpoint {

std::filesystem::path rendered_folder(const RenderRequest& request) {
  throw InputError("sequence \"" + request.preset + "\"",
                   "there is no folder of this name; give the path of a sequence");
}

std::unique_ptr<SensorStream> find_sequence(const std::string& name, const OpenOptions& options) {
  if (std::filesystem::is_directory(name)) return open_sequence(name, options);
  return open_sequence(rendered_folder({.preset = name}), options);
}

}  // namespace stillpoint
