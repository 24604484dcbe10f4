// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/damaged_database.h"

#include <fstream>

#include "bench/store/schema.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPageBytes = 4096;  // of stores: SQLite's default
// Fields of the header with 4 bytes, big-endian (SQLite file format, section 1.3).
constexpr std::size_t kPageCountOffset = 28;
constexpr std::size_t kApplicationIdOffset = 68;

/// Whether a file has the header of a database of another program.
bool is_foreign(const fs::path& file) {
  constexpr std::string_view kMagic{"SQLite format 3\0", 16};
  std::string header(kApplicationIdOffset + 4, '\0');
  std::ifstream(file, std::ios::binary).read(header.data(), static_cast<std::streamsize>(header.size()));
  std::int64_t id = 0;
  for (std::size_t i = 0; i < 4; ++i)
    id = 256 * id + static_cast<unsigned char>(header[kApplicationIdOffset + i]);
  return header.starts_with(kMagic) && id != kApplicationId;
}

/// Whether the list of tables can be read.
bool has_tables(const fs::path& file) {
  try {
    const Database database(file, DatabaseAccess::kRead);
    static_cast<void>(database.prepare("SELECT 1 FROM run, metric, timing, attachment, manifest, plan"));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// First page of an empty store, with the number of pages of `file`.
std::string empty_first_page(const fs::path& folder, const fs::path& file) {
  const fs::path empty = folder / "empty.sqlite";
  {
    const Database database(empty, DatabaseAccess::kWrite);
    migrate(database);
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  std::string page(kPageBytes, '\0');
  std::ifstream(empty, std::ios::binary).read(page.data(), static_cast<std::streamsize>(page.size()));
  std::uintmax_t pages = fs::file_size(file) / kPageBytes;
  for (std::size_t i = 4; i-- > 0; pages /= 256) page[kPageCountOffset + i] = static_cast<char>(pages % 256);
  return page;
}

void replace_first_page(const fs::path& file, const std::string& page) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.write(page.data(), static_cast<std::streamsize>(page.size()));
  if (!stream.flush()) throw InputError(file.string(), "cannot be written; check for a full disk");
}

void copy_to(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::copy_file(from, to, error))
    throw InputError(from.string(), "cannot be copied to " + to.string() + ": " + error.message());
}

}  // namespace

DamagedDatabase::DamagedDatabase(const fs::path& store, fs::path folder) : folder_(std::move(folder)) {
  if (!fs::is_regular_file(store)) throw InputError(store.string(), "there is no such store");
  std::error_code error;
  if (!fs::create_directories(folder_, error))
    throw InputError(folder_.string(), "cannot be created; remove it or choose another output");
  if (fs::space(folder_, error).available < fs::file_size(store) && !error) {
    fs::remove_all(folder_, error);
    throw InputError(store.string(), "is larger than the free space at " + folder_.string() +
                                         ", where a copy of it is repaired; choose another output");
  }
  const fs::path copy = folder_ / "store.sqlite";
  const fs::path log = store.string() + "-wal";
  try {
    copy_to(store, copy);
    if (fs::exists(log)) copy_to(log, copy.string() + "-wal");
    replaced_header_ = !is_foreign(copy) && !has_tables(copy);
    if (replaced_header_) replace_first_page(copy, empty_first_page(folder_, copy));
    if (replaced_header_ && !has_tables(copy))
      throw InputError(store.string(),
                       "contains nothing that can be read; it is no store, or completely damaged");
    database_ = std::make_unique<Database>(copy, DatabaseAccess::kRead);
    require_readable_schema(*database_);
  } catch (...) {
    database_.reset();
    fs::remove_all(folder_, error);
    throw;
  }
}

DamagedDatabase::~DamagedDatabase() {
  database_.reset();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::string order_text(const std::vector<std::string>& columns, const char* direction) {
  std::string text;
  for (const std::string& column : columns) text += (text.empty() ? "" : ", ") + column + direction;
  return text;
}

}  // namespace stillpoint::bench
