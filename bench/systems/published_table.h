// SPDX-License-Identifier: BSD-3-Clause
/// Numbers quoted from papers, each with its source; never averaged with measured ones.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace stillpoint {

struct PublishedRow {
  std::string system;
  std::string source;                    ///< short name, a key of `PublishedTable::sources`
  std::string note;                      ///< what is to be known about this row; may be empty
  std::map<std::string, double> values;  ///< by sequence or, in tables of costs, by module
};

/// A file of reports/published/.
struct PublishedTable {
  std::string name;
  std::string title;
  std::string metric;  ///< of `Metric::name`, or "mean_ms" for costs of modules
  std::string unit;
  std::string alignment;                   ///< under which the numbers were made
  std::vector<std::string> comparability;  ///< what to know before comparing, a sentence each
  std::map<std::string, std::string> sources;
  std::vector<PublishedRow> rows;
};

/// @param name embedded name ("tum_fr3_ate") or a TOML file
/// @throws InputError if there is none, or it is malformed, or a row names a source that the file does not
[[nodiscard]] PublishedTable load_published(const std::string& name);

/// Names of all embedded tables.
[[nodiscard]] std::vector<std::string> published_names();

}  // namespace stillpoint
