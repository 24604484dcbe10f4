// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/test_archive.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <archive.h>
#include <archive_entry.h>

namespace stillpoint {
namespace {

void set_kind(archive* writer, const std::string& name) {
  if (name.ends_with(".zip")) {
    archive_write_set_format_zip(writer);
  } else if (name.ends_with(".7z")) {
    archive_write_set_format_7zip(writer);
  } else {
    archive_write_set_format_pax_restricted(writer);
  }
  if (name.ends_with(".tgz") || name.ends_with(".gz")) archive_write_add_filter_gzip(writer);
  if (name.ends_with(".xz")) archive_write_add_filter_xz(writer);
  if (name.ends_with(".bz2")) archive_write_add_filter_bzip2(writer);
}

void write_entry(archive* writer, const TestEntry& file) {
  archive_entry* entry = archive_entry_new();
  archive_entry_set_pathname(entry, file.path.c_str());
  archive_entry_set_perm(entry, 0644);
  archive_entry_set_filetype(entry, file.link_target.empty() ? AE_IFREG : AE_IFLNK);
  if (!file.link_target.empty()) archive_entry_set_symlink(entry, file.link_target.c_str());
  archive_entry_set_size(entry, static_cast<la_int64_t>(file.content.size()));
  archive_write_header(writer, entry);
  archive_write_data(writer, file.content.data(), file.content.size());
  archive_entry_free(entry);
}

}  // namespace

void write_archive(const std::filesystem::path& file, const std::vector<TestEntry>& entries) {
  std::filesystem::create_directories(file.parent_path());
  archive* writer = archive_write_new();
  set_kind(writer, file.filename().string());
  if (archive_write_open_filename(writer, file.c_str()) != ARCHIVE_OK)
    throw std::runtime_error("the test archive cannot be written");
  for (const TestEntry& entry : entries) write_entry(writer, entry);
  archive_write_close(writer);
  archive_write_free(writer);
}

std::vector<TestEntry> folder_entries(const std::filesystem::path& folder, const std::string& prefix) {
  std::vector<TestEntry> entries;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream input(entry.path(), std::ios::binary);
    entries.push_back({prefix + entry.path().lexically_relative(folder).string(),
                       {std::istreambuf_iterator<char>(input), {}}});
  }
  std::ranges::sort(entries, {}, &TestEntry::path);
  return entries;
}

}  // namespace stillpoint
