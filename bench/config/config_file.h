// SPDX-License-Identifier: BSD-3-Clause
/// Resolves configs: a base file with the files it inherits, then overlays, then single settings. It is the
/// component `config` of an installation: `load_config({})` is the config of `stillpoint run`, and equal to
/// `OdometryConfig{}`.
///
/// Text form of a config: all keys with their values, for display, manifests and comparison.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/config/odometry_config.h"

namespace stillpoint::bench {

/// The config of a run.
struct ConfigRequest {
  std::string base = "stillpoint";    ///< embedded name or path of a file
  std::string variant;                ///< overlays joined by "+"; a base config among them replaces `base`
  std::vector<std::string> settings;  ///< "key=value", applied last
};

/// Reads and merges all files and settings of a request.
///
/// A file is a base if it is `stillpoint` or inherits it, directly or indirectly; any other is an overlay.
/// @throws InputError for unknown names, circular inheritance, two bases, and every fault of a file
[[nodiscard]] OdometryConfig load_config(const ConfigRequest& request);

/// One message, with its place, for each setting of the user that has no effect in the config of a request
/// (see bench/config/key_effects.h). Settings that equal those of the shipped configs are not listed, so that
/// a file may state all keys, e.g. the output of `stillpoint config show`.
/// @throws InputError as `load_config`
[[nodiscard]] std::vector<std::string> settings_without_effect(const ConfigRequest& request);

/// A config file and the files on disk that it inherits, directly or indirectly; absolute and normal paths.
/// @throws InputError as `load_config`
[[nodiscard]] std::vector<std::string> files_of_config(const std::string& file);

/// A TOML string: the text in double quotes, with backslashes before quotes and backslashes.
[[nodiscard]] std::string toml_quoted(std::string_view text);

/// One key and its value in TOML syntax.
struct ConfigEntry {
  std::string key;
  std::string value;
  friend bool operator==(const ConfigEntry&, const ConfigEntry&) = default;
};

/// All keys in the order of the field lists; numbers are printed such that they are read back bit-exactly.
[[nodiscard]] std::vector<ConfigEntry> config_entries(const OdometryConfig& config);

/// The entries as TOML text with dotted keys, one per line.
[[nodiscard]] std::string config_text(const OdometryConfig& config);

/// The entries of `changed` whose values differ from those of `parent`.
[[nodiscard]] std::vector<ConfigEntry> config_difference(const OdometryConfig& parent,
                                                         const OdometryConfig& changed);

/// Reference page of all keys: a Markdown table of key, meaning, type or choices, range with unit, default
/// and section of the paper.
[[nodiscard]] std::string config_reference();

}  // namespace stillpoint::bench
