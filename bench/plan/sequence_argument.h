// SPDX-License-Identifier: BSD-3-Clause
/// The argument SEQ of commands on one sequence: a folder, a registered name, a name of the
/// catalogue or a preset.
#pragma once

#include <string>

namespace stillpoint::bench {

/// Replaces a registered name, or that of the catalogue ("tum/fr3_walking_xyz"), by its folder; folders and
/// presets are returned as they are. Reads all files of a registered sequence to verify its checksum.
/// @throws InputError for a name that is neither, for one that is both registered and a preset, and for a
/// file
[[nodiscard]] std::string resolve_sequence(const std::string& given);

}  // namespace stillpoint::bench
