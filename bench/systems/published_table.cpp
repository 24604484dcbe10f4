// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/published_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "bench/config/spelling.h"
#include "bench/config/toml_source.h"
#include "bench/model/metrics.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

/// Parser of one file; stores the file name for error messages.
struct PublishedReader {
  std::string place;

  [[noreturn]] void fail(const toml::node& node, const std::string& problem) const {
    throw InputError(place, static_cast<long>(node.source().begin.line), problem);
  }

  [[nodiscard]] std::string text(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr || !node->is_string()) fail(table, fmt::format("requires a string \"{}\"", key));
    return node->as_string()->get();
  }

  /// A part of the file; null without it.
  template <class Type>
  [[nodiscard]] const Type* part(const toml::table& root, const char* key, const char* form) const {
    const toml::node* node = root.get(key);
    if (node != nullptr && node->as<Type>() == nullptr)
      fail(*node, fmt::format("\"{}\" must be {}", key, form));
    return node == nullptr ? nullptr : node->as<Type>();
  }

  /// Rejects what would be left out.
  void require_known(const toml::table& table, std::span<const std::string> known) const {
    for (const auto& [key, value] : table) {
      const std::string name(key.str());
      if (std::ranges::find(known, name) == known.end())
        fail(value, fmt::format("unknown key \"{}\"{}", name, suggestion(name, known)));
    }
  }

  /// Of a metric that is measured: its values are shown beside the published ones.
  void require_unit(const toml::table& root, const PublishedTable& table) const {
    const MetricDescriptor* metric = find_metric(without_protocol(table.metric));
    if (metric == nullptr || metric->unit == table.unit) return;
    fail(*root.get("unit"), fmt::format("\"unit\" is \"{}\", but {} is measured in \"{}\"; convert the "
                                        "values, and change the unit",
                                        table.unit, table.metric, metric->unit));
  }

  /// @param root contains the default of `input`
  [[nodiscard]] PublishedRow row(const toml::node& node, const toml::table& root) const {
    const toml::table* table = node.as_table();
    if (table == nullptr) fail(node, "a row must be a table: [[row]]");
    const std::string kKeys[] = {"system", "source", "input", "note", "values"};
    require_known(*table, kKeys);
    PublishedRow row{.system = text(*table, "system"), .source = text(*table, "source")};
    const bool has_default = !table->contains("input") && root.contains("input");
    row.input = text(has_default ? root : *table, "input");
    if (table->contains("note")) row.note = text(*table, "note");
    const toml::node* values = table->get("values");
    if (values == nullptr || !values->is_table()) fail(*table, "requires values = {sequence = number, ...}");
    for (const auto& [name, value] : *values->as_table()) {
      if (!value.is_number()) fail(value, fmt::format("\"{}\" must be a number", name.str()));
      const double number = value.value<double>().value();
      if (!std::isfinite(number) || number < 0.0)
        fail(value, fmt::format("\"{}\" is {}; leave a value out that is not known", name.str(), number));
      row.values[std::string(name.str())] = number;
    }
    return row;
  }

  /// The names of the recordings, and the values of all rows under these names as well.
  [[nodiscard]] PublishedTable with_recordings(PublishedTable table, const toml::table& root) const {
    const auto* recordings = part<toml::table>(root, "recordings", "a table: [recordings]");
    if (recordings == nullptr) return table;
    for (const auto& [name, recording] : *recordings) {
      if (!recording.is_string()) fail(recording, fmt::format("\"{}\" must be a string", name.str()));
      table.recordings[std::string(name.str())] = recording.as_string()->get();
    }
    for (PublishedRow& row : table.rows) {
      for (const auto& [name, recording] : table.recordings) {
        const auto value = row.values.find(name);
        if (value != row.values.end()) row.values[recording] = value->second;
      }
    }
    return table;
  }

  [[nodiscard]] PublishedTable table(const toml::table& root) const {
    const std::string kKeys[] = {"title",         "metric",     "unit",    "alignment", "input",
                                 "comparability", "recordings", "sources", "row"};
    require_known(root, kKeys);
    PublishedTable table{.name = std::filesystem::path(place).stem().string(),
                         .title = text(root, "title"),
                         .metric = text(root, "metric"),
                         .unit = text(root, "unit"),
                         .alignment = text(root, "alignment")};
    require_unit(root, table);
    if (const auto* notes = part<toml::array>(root, "comparability", "a list of strings")) {
      for (const toml::node& note : *notes) table.comparability.push_back(note.value_or(std::string()));
    }
    if (const auto* sources = part<toml::table>(root, "sources", "a table: [sources]")) {
      for (const auto& [name, source] : *sources)
        table.sources[std::string(name.str())] = source.value_or(std::string());
    }
    if (const auto* rows = part<toml::array>(root, "row", "a list of tables: [[row]]")) {
      for (const toml::node& node : *rows) {
        table.rows.push_back(row(node, root));
        if (!table.sources.contains(table.rows.back().source)) {
          fail(node, "source \"" + table.rows.back().source + "\" is not in [sources]; add it there");
        }
      }
    }
    return with_recordings(std::move(table), root);
  }
};

}  // namespace

PublishedTable load_published(const std::string& name) {
  const TomlSource source = find_toml(name, TomlKind::kPublished);
  try {
    return PublishedReader{source.path}.table(toml::parse(source.text, source.path));
  } catch (const toml::parse_error& error) {
    throw InputError(source.path, static_cast<long>(error.source().begin.line),
                     "not valid TOML: " + std::string(error.description()));
  }
}

std::string system_label(const PublishedRow& row) { return row.system + " (" + row.input + ")"; }

std::vector<std::string> published_names() { return embedded_names(TomlKind::kPublished); }

}  // namespace stillpoint::bench
