// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/catalogue/catalogue.h"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "core/base/error.h"

namespace stillpoint::datasets {

const CatalogueArchive& archive_of(const CatalogueDataset& dataset, const std::string& file) {
  const auto found = std::ranges::find(dataset.archives, file, &CatalogueArchive::file);
  STILLPOINT_CHECK(found != dataset.archives.end());
  return *found;
}

std::string catalogue_name(const CatalogueDataset& dataset, const CatalogueSequence& sequence) {
  return dataset.name + "/" + sequence.name;
}

std::string registered_name(const CatalogueDataset& dataset, const CatalogueSequence& sequence) {
  return dataset.name + "_" + sequence.name;
}

std::uint64_t published_bytes(const CatalogueDataset& dataset, const std::vector<std::string>& files) {
  std::uint64_t sum = 0;
  for (const std::string& file : files) {
    const std::uint64_t bytes = archive_of(dataset, file).bytes;
    if (bytes == 0) return 0;
    sum += bytes;
  }
  return sum;
}

std::vector<CatalogueEntry> matching_entries(const std::vector<CatalogueDataset>& datasets,
                                             const std::string& pattern) {
  std::vector<CatalogueEntry> found;
  for (const CatalogueDataset& dataset : datasets) {
    for (const CatalogueSequence& sequence : dataset.sequences) {
      const auto matches = [&](const std::string& name) {
        return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
      };
      const bool in_group = !sequence.group.empty() && matches(dataset.name + "/" + sequence.group);
      if (matches(catalogue_name(dataset, sequence)) || matches(registered_name(dataset, sequence)) ||
          in_group || pattern == dataset.name) {
        found.push_back({&dataset, &sequence});
      }
    }
  }
  return found;
}

namespace {

constexpr std::size_t kMaxSequences = 10000;
constexpr std::string_view kNameCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
constexpr std::string_view kHexDigits = "0123456789abcdef";
constexpr std::size_t kSha256Digits = 64;
constexpr std::size_t kMd5Digits = 32;

/// `text` with each {} replaced.
std::string filled(const std::string& text, const std::string& replacement) {
  std::string result;
  std::size_t begin = 0;
  for (std::size_t at = text.find("{}"); at != std::string::npos; at = text.find("{}", begin)) {
    result += text.substr(begin, at - begin) + replacement;
    begin = at + 2;
  }
  return result + text.substr(begin);
}

/// Reads tables of one file, and reports problems with its name and the line.
class CatalogueReader {
 public:
  explicit CatalogueReader(std::string place) : place_(std::move(place)) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& problem) const {
    throw InputError(place_, static_cast<long>(node.source().begin.line), problem);
  }

  void require_known_keys(const toml::table& table, std::initializer_list<std::string_view> known) const {
    for (const auto& [key, value] : table) {
      if (std::ranges::find(known, key.str()) != known.end()) continue;
      fail(value, fmt::format("unknown key \"{}\"; expected one of: {}", key.str(), fmt::join(known, ", ")));
    }
  }

  /// @return `fallback` if the key is not set
  [[nodiscard]] std::string text(const toml::table& table, std::string_view key, std::string fallback) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return fallback;
    if (!node->is_string()) fail(*node, fmt::format("\"{}\" must be a string", key));
    return node->as_string()->get();
  }

  [[nodiscard]] std::string required_text(const toml::table& table, std::string_view key) const {
    std::string value = text(table, key, "");
    if (value.empty()) fail(table, fmt::format("requires a string \"{}\"", key));
    return value;
  }

  [[nodiscard]] std::vector<std::string> texts(const toml::table& table, std::string_view key) const {
    std::vector<std::string> values;
    const toml::node* node = table.get(key);
    if (node == nullptr) return values;
    if (!node->is_array()) fail(*node, fmt::format("\"{}\" must be a list of strings", key));
    for (const toml::node& element : *node->as_array()) {
      if (!element.is_string()) fail(element, fmt::format("\"{}\" must be a list of strings", key));
      values.push_back(element.as_string()->get());
    }
    return values;
  }

  [[nodiscard]] std::string name(const toml::table& table, const std::string& value) const {
    const bool is_valid = !value.empty() && !value.starts_with('.') &&
                          value.find_first_not_of(kNameCharacters) == std::string::npos;
    if (!is_valid)
      fail(table, "name \"" + value + "\" is invalid; use letters, digits, '_', '-' and '.' only");
    return value;
  }

  /// A relative path that stays in its folder.
  [[nodiscard]] std::string path(const toml::table& table, const std::string& value) const {
    const std::filesystem::path given(value);
    const bool leaves = std::ranges::any_of(given, [](const auto& part) { return part == ".."; });
    if (value.empty() || value.find('\0') != std::string::npos || given.is_absolute() || leaves)
      fail(table, "path \"" + value + "\" is invalid; it must be relative and without \"..\"");
    return value;
  }

  /// @param digits number of hexadecimal digits
  [[nodiscard]] std::string digest(const toml::table& table, std::string_view key, std::size_t digits) const {
    std::string value = text(table, key, "");
    const bool is_hex = value.find_first_not_of(kHexDigits) == std::string::npos;
    if (value.empty() || (value.size() == digits && is_hex)) return value;
    fail(table, fmt::format("\"{}\" must have {} lower-case hexadecimal digits", key, digits));
  }

  [[nodiscard]] std::uint64_t size(const toml::table& table, std::string_view key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return 0;
    const std::optional<std::int64_t> value = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
    if (!value || *value < 1) fail(*node, fmt::format("\"{}\" must be a positive number of bytes", key));
    return static_cast<std::uint64_t>(*value);
  }

  [[nodiscard]] std::vector<std::string> addresses(const toml::table& table, std::string_view key) const {
    std::vector<std::string> values = texts(table, key);
    for (const std::string& value : values) {
      if (value.starts_with("http://") || value.starts_with("https://")) continue;
      fail(*table.get(key), "address \"" + value + "\" must begin with http:// or https://");
    }
    return values;
  }

  [[nodiscard]] CatalogueArchive archive(const std::string& file, const toml::table& root) const {
    CatalogueArchive archive{.file = path(root, file)};
    for (const std::string& base : addresses(root, "urls")) archive.urls.push_back(filled(base, file));
    const toml::table* digests = root["archives"].as_table();
    const toml::node* known = digests == nullptr ? nullptr : digests->get(file);
    if (known == nullptr) return archive;
    const toml::table* table = known->as_table();
    if (table == nullptr) fail(*known, "must be a table: [archives.\"" + file + "\"]");
    require_known_keys(*table, {"bytes", "sha256", "md5", "urls"});
    archive.bytes = size(*table, "bytes");
    archive.sha256 = digest(*table, "sha256", kSha256Digits);
    archive.md5 = digest(*table, "md5", kMd5Digits);
    if (table->contains("urls")) archive.urls = addresses(*table, "urls");
    return archive;
  }

  [[nodiscard]] CatalogueSequence sequence(const toml::table& series, const std::string& member) const {
    CatalogueSequence sequence{
        .name = name(series, filled(text(series, "name", "{}"), member)),
        .group = text(series, "group", ""),
        .archives = {},
        .folder = path(series, filled(text(series, "folder", "{}"), member)),
    };
    for (const std::string& file : texts(series, "files"))
      sequence.archives.push_back(path(series, filled(file, member)));
    return sequence;
  }

 private:
  std::string place_;
};

/// Adds the sequences of one [[sequences]] table, and the archives that they need.
CatalogueDataset with_series(CatalogueDataset dataset, const CatalogueReader& reader, const toml::table& root,
                             const toml::table& series) {
  reader.require_known_keys(series, {"members", "name", "folder", "files", "group"});
  const std::vector<std::string> members = reader.texts(series, "members");
  if (members.empty()) reader.fail(series, "requires a list \"members\"");
  for (const std::string& member : members) {
    CatalogueSequence sequence = reader.sequence(series, member);
    if (std::ranges::find(dataset.sequences, sequence.name, &CatalogueSequence::name) !=
        dataset.sequences.end())
      reader.fail(series, "sequence \"" + sequence.name + "\" occurs twice; remove one");
    for (const std::string& file : sequence.archives) {
      const auto known = std::ranges::find(dataset.archives, file, &CatalogueArchive::file);
      if (known == dataset.archives.end()) dataset.archives.push_back(reader.archive(file, root));
    }
    dataset.sequences.push_back(std::move(sequence));
    if (dataset.sequences.size() > kMaxSequences) reader.fail(series, "has more than 10000 sequences");
  }
  return dataset;
}

/// Entries of [archives] that no sequence uses are misspelled.
void require_used_archives(const CatalogueDataset& dataset, const CatalogueReader& reader,
                           const toml::table& root) {
  const toml::node* node = root.get("archives");
  if (node == nullptr) return;
  const toml::table* table = node->as_table();
  if (table == nullptr) reader.fail(*node, "\"archives\" must be a table");
  for (const auto& [file, value] : *table) {
    if (std::ranges::find(dataset.archives, file.str(), &CatalogueArchive::file) == dataset.archives.end())
      reader.fail(value, fmt::format("no sequence uses the file \"{}\"; correct its name", file.str()));
  }
}

CatalogueDataset read_dataset(const CatalogueReader& reader, const toml::table& root) {
  reader.require_known_keys(
      root, {"name", "title", "homepage", "licence", "citation", "layout", "user_agent", "md5_suffix",
             "token_variable", "manual", "rig", "notes", "urls", "sequences", "archives"});
  CatalogueDataset dataset{.name = reader.name(root, reader.required_text(root, "name")),
                           .title = reader.required_text(root, "title"),
                           .homepage = reader.text(root, "homepage", ""),
                           .licence = reader.required_text(root, "licence"),
                           .citation = reader.text(root, "citation", ""),
                           .layout = reader.required_text(root, "layout"),
                           .user_agent = reader.text(root, "user_agent", ""),
                           .md5_suffix = reader.text(root, "md5_suffix", ""),
                           .token_variable = reader.text(root, "token_variable", ""),
                           .manual = reader.text(root, "manual", ""),
                           .rig = reader.text(root, "rig", ""),
                           .notes = reader.texts(root, "notes"),
                           .archives = {},
                           .sequences = {}};
  const toml::array* all_series = root["sequences"].as_array();
  if (all_series == nullptr) reader.fail(root, "requires [[sequences]]");
  for (const toml::node& node : *all_series) {
    const toml::table* series = node.as_table();
    if (series == nullptr) reader.fail(node, "sequences must be tables: [[sequences]]");
    dataset = with_series(std::move(dataset), reader, root, *series);
  }
  require_used_archives(dataset, reader, root);
  return dataset;
}

/// toml++ 3.3 has undefined behavior for a NUL byte after "[", and for some characters that are not ASCII.
void require_ascii(std::string_view text, const std::string& place) {
  const auto is_text = [](unsigned char c) {
    return (c >= 0x20 && c < 0x7f) || c == '\n' || c == '\r' || c == '\t';
  };
  const auto found = std::ranges::find_if_not(text, is_text);
  if (found == text.end()) return;
  throw InputError(place, 1 + std::count(text.begin(), found, '\n'),
                   fmt::format("contains the byte 0x{:02x}; write only ASCII characters, others as in LaTeX",
                               static_cast<unsigned char>(*found)));
}

}  // namespace

CatalogueDataset parse_catalogue(std::string_view text, const std::string& place) {
  require_ascii(text, place);
  try {
    const toml::table root = toml::parse(text, place);
    return read_dataset(CatalogueReader(place), root);
  } catch (const toml::parse_error& error) {
    throw InputError(place, static_cast<long>(error.source().begin.line),
                     "not valid TOML: " + std::string(error.description()));
  }
}

}  // namespace stillpoint::datasets
