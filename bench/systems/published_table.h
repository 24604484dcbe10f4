// SPDX-License-Identifier: BSD-3-Clause
/// Results quoted from papers, with their sources; never averaged with measured results.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace stillpoint::bench {

struct PublishedRow {
  std::string system;
  std::string source;  ///< short name, a key of `PublishedTable::sources`
  std::string input;   ///< sensors that were used, e.g. "RGB-D, IMU", or "not stated"
  std::string note;    ///< remark on the row; may be empty
  /// By sequence, under the name of the table and that of the registered recording; by module in cost tables.
  std::map<std::string, double> values;
};

/// A file of reports/published/.
struct PublishedTable {
  std::string name;
  std::string title;
  std::string metric;  ///< of `Metric::name`, or "mean_ms" for costs of modules
  std::string unit;
  std::string alignment;                   ///< trajectory alignment used for the results
  std::vector<std::string> comparability;  ///< limits of comparability, one sentence each
  std::map<std::string, std::string> sources;
  std::map<std::string, std::string> recordings;  ///< registered name by name in the table: [recordings]
  std::vector<PublishedRow> rows;
};

/// @param name embedded name ("tum_fr3_ate") or a TOML file
/// @throws InputError if there is no such file, it is malformed, has an unknown key, a number that is
/// negative or not finite, or another unit than the metric is measured in, a source is not listed in
/// [sources], or a row has no input and the table has no default
[[nodiscard]] PublishedTable load_published(const std::string& name);

/// The system with its input: "NGD-SLAM (RGB-D)".
[[nodiscard]] std::string system_label(const PublishedRow& row);

/// Names of all embedded tables.
[[nodiscard]] std::vector<std::string> published_names();

}  // namespace stillpoint::bench
