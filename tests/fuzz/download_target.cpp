// SPDX-License-Identifier: BSD-3-Clause
/// Fuzz target that parses arbitrary bytes as a catalogue file, as HTTP headers, and as an archive, which it
/// extracts. The parsers may throw InputError only, and write nothing outside of their folder.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <unistd.h>

#include "core/base/error.h"
#include "datasets/catalogue/catalogue.h"
#include "datasets/download/archive_extraction.h"
#include "datasets/download/http_transfer.h"
#include "datasets/download/transfer_checks.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

/// A folder of /dev/shm, if that exists, with nothing else in it.
const fs::path& scratch_folder() {
  static const fs::path kFolder = [] {
    std::string pattern =
        fs::is_directory("/dev/shm") ? "/dev/shm/stillpoint-fuzz-XXXXXX" : "/tmp/stillpoint-fuzz-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    return fs::path(pattern);
  }();
  return kFolder;
}

void write_file(const fs::path& file, std::string_view bytes) {
  std::FILE* output = std::fopen(file.c_str(), "wb");
  if (output == nullptr) std::abort();
  std::fwrite(bytes.data(), 1, bytes.size(), output);
  std::fclose(output);
}

void parse_catalogue_text(std::string_view text) {
  try {
    const CatalogueDataset dataset = parse_catalogue(text, "fuzz");
    static_cast<void>(matching_entries({dataset}, dataset.name + "/*"));
  } catch (const InputError&) {  // rejected
  }
}

void parse_headers(std::string_view text) {
  ResponseHeaders headers;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    headers = with_header_line(std::move(headers), text.substr(begin, end - begin));
    begin = end + 1;
  }
  static_cast<void>(is_html(text));
}

void extract(std::string_view bytes) {
  const fs::path folder = scratch_folder() / "case";
  fs::create_directories(folder);
  write_file(folder / "a.zip", bytes);
  try {
    static_cast<void>(extract_archive(folder / "a.zip", folder / "out",
                                      {.max_bytes = 1'000'000, .max_entries = 100, .max_depth = 2}, {}));
  } catch (const InputError&) {            // rejected
  } catch (const fs::filesystem_error&) {  // names that the file system does not accept
  }
  std::size_t entries = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch_folder())) {
    entries += entry.path() == folder ? 1 : 2;
  }
  if (entries != 1) std::abort();  // something was written outside
  fs::remove_all(folder);
}

}  // namespace
}  // namespace stillpoint::datasets

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  stillpoint::datasets::parse_catalogue_text(bytes);
  stillpoint::datasets::parse_headers(bytes);
  stillpoint::datasets::extract(bytes);
  return 0;
}
