// SPDX-License-Identifier: BSD-3-Clause
/// The sequences that the names and globs of a plan stand for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/plan/bench_plan.h"
#include "datasets/synthetic/render_sequence.h"

namespace stillpoint {

/// A sequence of a plan: one that is rendered when its first run comes, or a folder.
struct PlanSequence {
  std::string name;                       ///< in tables
  std::string id;                         ///< what its content is known by
  std::optional<SynthRequest> rendering;  ///< of a rendered one
  std::filesystem::path folder;           ///< of a recorded one
  std::string missing;                    ///< why it takes no part; empty if it does
};

/// Presets that match one of the names or globs, in the order of these.
/// @throws InputError for a name or glob that matches none
[[nodiscard]] std::vector<std::string> matching_presets(const std::vector<std::string>& patterns);

/// What a plan renders for one preset and seed.
/// @param axis changed in addition: `key` with the prefix "synth.", and one value; empty key: nothing
[[nodiscard]] PlanSequence rendered_sequence(const BenchPlan& plan, const std::string& preset, int seed,
                                             const SweepAxis& axis);

/// The recorded sequences of a plan; reads every byte of them for their checksums. One that is not at hand is
/// marked as missing if the group is not required.
/// @throws InputError for a required one that is not at hand, and for one whose files are not what was
/// registered
[[nodiscard]] std::vector<PlanSequence> recorded_sequences(const RecordedGroup& group);

/// Folder with the sequence's files, rendered now if need be; empty if that was stopped.
/// @throws InputError if it cannot be rendered or has vanished
[[nodiscard]] std::filesystem::path sequence_folder(const PlanSequence& sequence,
                                                    const RenderControl& control);

/// The folder of recorded sequences: STILLPOINT_DATA, else ../shared/data from where the program is called.
[[nodiscard]] std::filesystem::path data_folder();

}  // namespace stillpoint
