// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/shared_module.h"
#include "reports/drawing/drawing_module.h"

namespace stillpoint::report {

const DrawingModule* drawing_module() {
  return static_cast<const DrawingModule*>(datasets::module_symbol("drawing", "stillpoint_drawing_module"));
}

}  // namespace stillpoint::report
