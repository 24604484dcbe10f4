// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/published_table.h"

#include <filesystem>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "bench/config/toml_source.h"
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

  /// @param root contains the default of `input`
  [[nodiscard]] PublishedRow row(const toml::node& node, const toml::table& root) const {
    const toml::table* table = node.as_table();
    if (table == nullptr) fail(node, "a row must be a table: [[row]]");
    PublishedRow row{.system = text(*table, "system"), .source = text(*table, "source")};
    const bool has_default = !table->contains("input") && root.contains("input");
    row.input = text(has_default ? root : *table, "input");
    if (table->contains("note")) row.note = text(*table, "note");
    const toml::node* values = table->get("values");
    if (values == nullptr || !values->is_table()) fail(*table, "requires values = {sequence = number, ...}");
    for (const auto& [name, value] : *values->as_table()) {
      if (!value.is_number()) fail(value, fmt::format("\"{}\" must be a number", name.str()));
      row.values[std::string(name.str())] = value.value<double>().value();
    }
    return row;
  }

  /// The names of the recordings, and the values of all rows under these names as well.
  [[nodiscard]] PublishedTable with_recordings(PublishedTable table, const toml::table& root) const {
    const toml::table* recordings = root["recordings"].as_table();
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
    PublishedTable table{.name = std::filesystem::path(place).stem().string(),
                         .title = text(root, "title"),
                         .metric = text(root, "metric"),
                         .unit = text(root, "unit"),
                         .alignment = text(root, "alignment")};
    if (const toml::array* notes = root["comparability"].as_array()) {
      for (const toml::node& note : *notes) table.comparability.push_back(note.value_or(std::string()));
    }
    if (const toml::table* sources = root["sources"].as_table()) {
      for (const auto& [name, source] : *sources)
        table.sources[std::string(name.str())] = source.value_or(std::string());
    }
    if (const toml::array* rows = root["row"].as_array()) {
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
