// SPDX-License-Identifier: BSD-3-Clause
/// Replicates of a deterministic run: runs with the same config and data, whose input is perturbed with
/// different seeds (core/pipeline/stages/input_perturbation.h). The seed is the last part of the config hash,
/// "0123456789abcdef-perturbed-3", so that replicates have different identities and are recognized as such.
#pragma once

#include <string>
#include <string_view>

namespace stillpoint::bench {

/// The config key of the seed.
inline constexpr std::string_view kPerturbationKey = "pipeline.perturbation_seed";

/// @param hash of the config without the seed
/// @param seed 0: the hash is not changed
[[nodiscard]] std::string perturbed_hash(const std::string& hash, int seed);

/// The hash without the seed, which replicates share.
[[nodiscard]] std::string_view unperturbed_hash(std::string_view config_hash);

/// Whether the hash is that of a perturbed run.
[[nodiscard]] bool is_perturbed(std::string_view config_hash);

}  // namespace stillpoint::bench
