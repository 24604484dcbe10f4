// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/tiles/projection.h"

#include "core/base/error.h"
#include "datasets/io/shared_module.h"

namespace stillpoint::datasets {

const ProjectionModule& projection_module() {
  try {
    return *static_cast<const ProjectionModule*>(module_symbol("projection", "stillpoint_projection_module"));
  } catch (const InputError& error) {
    throw InputError(
        "--map-tiles",
        std::string("requires PROJ (to build it: libproj-dev, configure again): ") + error.what());
  }
}

}  // namespace stillpoint::datasets
