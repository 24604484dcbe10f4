// SPDX-License-Identifier: BSD-3-Clause
/// Resolves the sequence names and globs of a plan.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/plan/bench_plan.h"
#include "bench/plan/sequence_registry.h"
#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint::bench {

/// A sequence of a plan: a synthetic one, rendered before its first run, or a recorded one.
struct PlanSequence {
  std::string name;                              ///< shown in tables
  std::string id;                                ///< identifies the content: request key or checksum
  std::optional<synth::SynthRequest> rendering;  ///< of a synthetic sequence
  std::filesystem::path folder;                  ///< of a recorded sequence
  std::string unavailable_reason;  ///< why a recorded sequence cannot be used; empty if it is available
  bool frame_cache = true;         ///< a rendering is written to the frame cache as well
};

/// Presets that match one of the names or globs, in the order of the patterns, each once.
/// @throws InputError for a name or glob without a match
[[nodiscard]] std::vector<std::string> matching_presets(const std::vector<std::string>& patterns);

/// The synthetic sequence of a plan for one preset and seed.
/// @param axis sweep point: `key` with the prefix "synth." and one value; an empty key changes nothing
[[nodiscard]] PlanSequence rendered_sequence(const BenchPlan& plan, const std::string& preset, int seed,
                                             const SweepAxis& axis);

/// The recorded sequences of a plan; reads all their files to compute checksums. Unavailable sequences get an
/// `unavailable_reason` if the group is not required. A sequence selected by several patterns occurs once.
/// @throws InputError if a required sequence is not available, a folder given by its path does not exist, the
/// files of a registered sequence have changed, or two folders have the same name
[[nodiscard]] std::vector<PlanSequence> recorded_sequences(const RecordedGroup& group);

/// The sequence of a registration, after reading all its files to verify the checksum.
/// @throws InputError if the folder does not exist, or its files have changed since the registration
[[nodiscard]] PlanSequence verified_sequence(const RegisteredSequence& registered);

/// Folder with the files of the sequence, rendered first if necessary; empty if the rendering was stopped.
/// @throws InputError if it cannot be rendered or no longer exists
[[nodiscard]] std::filesystem::path sequence_folder(const PlanSequence& sequence,
                                                    const synth::RenderControl& control);

/// The folder of recorded sequences: $STILLPOINT_DATA, else ../shared/data relative to the working directory.
[[nodiscard]] std::filesystem::path data_folder();

}  // namespace stillpoint::bench
