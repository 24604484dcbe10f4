// SPDX-License-Identifier: BSD-3-Clause
/// Sequences by their names: those of a plan, with globs, and the argument SEQ of commands on one sequence,
/// which is a folder, a registered name, a name of the catalogue or a preset.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/plan/bench_plan.h"
#include "datasets/synthetic/sequence/presets.h"
#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint::bench {

/// Beginning of the keys of plans that belong to a rendering request.
inline constexpr std::string_view kSynthPrefix = "synth.";

/// Returns the request with one numeric field changed.
/// @param key dotted, e.g. "walkers", "depth.noise_per_m", "imu.gyro_bias"
/// @throws InputError for an unknown key (with the nearest one), for a fraction if the field is an integer,
/// and for a value out of range
[[nodiscard]] synth::SynthRequest with_number(synth::SynthRequest request, const std::string& key,
                                              double value);

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

/// Folder with the files of the sequence, rendered first if necessary; empty if the rendering was stopped.
/// @throws InputError if it cannot be rendered or no longer exists
[[nodiscard]] std::filesystem::path sequence_folder(const PlanSequence& sequence,
                                                    const synth::RenderControl& control);

/// The folder of recorded sequences: $STILLPOINT_DATA, else ../shared/data relative to the working directory.
[[nodiscard]] std::filesystem::path data_folder();

/// Replaces a registered name, or that of the catalogue ("tum/fr3_walking_xyz"), by its folder; folders and
/// presets are returned as they are. Reads all files of a registered sequence to verify its checksum.
/// @throws InputError for a name that is neither, for one that is both registered and a preset, and for a
/// file
[[nodiscard]] std::string resolve_sequence(const std::string& given);

}  // namespace stillpoint::bench
