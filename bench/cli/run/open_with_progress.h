// SPDX-License-Identifier: BSD-3-Clause
/// Opens the sequence of a run.
#pragma once

#include <memory>
#include <string>

#include "datasets/open_sequence.h"

namespace stillpoint::bench {

/// `find_sequence` with a progress line while a preset is rendered.
/// @return null if interrupted
[[nodiscard]] std::unique_ptr<datasets::SensorStream> open_with_progress(
    const std::string& name, const datasets::OpenOptions& options);

}  // namespace stillpoint::bench
