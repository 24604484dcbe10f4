// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/sequence_source.h"

#include "core/base/error.h"

namespace stillpoint {

std::unique_ptr<SensorStream> find_sequence(const std::string& name, const OpenOptions& options) {
  if (std::filesystem::is_directory(name)) return open_sequence(name, options);
  throw InputError("sequence \"" + name + "\"",
                   "there is no folder of this name; give the path of a sequence");
}

}  // namespace stillpoint
