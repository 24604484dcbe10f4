// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_file.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/io/file_descriptor.h"
#include "datasets/io/sensor_yaml.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";

/// The parts of a split bag of ROS 1, or the files of a folder of rosbag2, as metadata.yaml lists them.
std::vector<fs::path> files_of_folder(const fs::path& folder) {
  std::vector<fs::path> files = eval::split_bag_parts(folder);
  if (!files.empty()) return files;
  const SensorYaml metadata(folder / "metadata.yaml");
  for (const std::string& name : metadata.child("rosbag2_bagfile_information").texts("relative_file_paths")) {
    const fs::path file = folder / fs::path(name).filename();
    if (file.extension() == ".zstd")
      throw InputError(
          file.string(),
          "is compressed as a whole; decompress it with `zstd -d`, and remove .zstd in metadata.yaml");
    files.push_back(file);
  }
  if (files.empty())
    throw InputError((folder / "metadata.yaml").string(),
                     "lists no files; restore it with `ros2 bag reindex`");
  return files;
}

/// @throws InputError for files without a content, which no container recognizes
void require_content(const fs::path& path) {
  constexpr std::string_view kLfsPointer = "version https://git-lfs";
  const ByteFile file(path);
  if (file.size() == 0) throw InputError(path.string(), "is empty (0 bytes); copy or record it again");
  const std::string beginning = file.read(0, 64);
  if (beginning.starts_with(kLfsPointer))
    throw InputError(path.string(), "is a pointer of Git LFS, not the bag; run `git lfs pull`");
  if (beginning.find_first_not_of('\0') == std::string::npos)
    throw InputError(path.string(), "begins with zero bytes only; copy it again");
}

/// The type in the spelling of ROS 1: "sensor_msgs/Image" of "sensor_msgs/msg/Image".
std::string ros1_type(std::string type) {
  const std::size_t middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.replace(middle, 5, "/");
}

void require_compression(const fs::path& path, bool supported, const char* supported_names) {
  if (!supported)
    throw InputError(path.string(),
                     std::string("this container has no such compression; use one of: ") + supported_names);
}

}  // namespace

BagFile::BagFile(const fs::path& path) : path_(path) {
  if (!eval::is_bag(path))
    throw InputError(path.string(),
                     "is no bag; expected a file .bag, .mcap or .db3, or a folder of rosbag2 or of "
                     "NAME_0.bag, NAME_1.bag");
  if (fs::is_directory(path)) {
    for (const fs::path& file : files_of_folder(path)) add_file(file);
  } else {
    add_file(path);
  }
  if (messages_.empty()) throw InputError(path.string(), "contains no messages; record or copy it again");
  std::ranges::stable_sort(messages_, {},
                           [](const MessageReference& reference) { return reference.message.t; });
}

void BagFile::add_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw InputError(path.string(), "no such file");
  require_content(path);
  File file{.path = path,
            .container = nullptr,
            .first_connection = static_cast<std::uint32_t>(connections_.size())};
  if (path.extension() == ".bag") {
    file.container = std::make_unique<Container>(std::in_place_type<Ros1Bag>, path);
  } else if (path.extension() == ".mcap") {
    file.container = std::make_unique<Container>(std::in_place_type<McapFile>, path);
  } else {
    file.container = std::make_unique<Container>(std::in_place_type<Rosbag2Database>, path);
  }
  const BagIndex& index =
      std::visit([](const auto& container) -> const BagIndex& { return container.index(); }, *file.container);
  for (BagConnection connection : index.connections) {
    connection.type = ros1_type(std::move(connection.type));
    connections_.push_back(std::move(connection));
  }
  for (BagMessage message : index.messages) {
    message.connection += file.first_connection;
    messages_.push_back({.message = message, .file = static_cast<std::uint32_t>(files_.size())});
  }
  complete_ &= index.complete;
  for (const std::string& warning : index.warnings) warnings_.push_back(path.string() + ": " + warning);
  files_.push_back(std::move(file));
}

std::string BagFile::payload(const MessageReference& reference, std::uint64_t max_bytes) const {
  const Container& container = *files_[reference.file].container;
  const auto read = [&](std::uint64_t count) {
    if (const auto* const database = std::get_if<Rosbag2Database>(&container))
      return database->payload(reference.message);
    if (const auto* const mcap = std::get_if<McapFile>(&container))
      return mcap->payload(reference.message, count);
    return std::get<Ros1Bag>(container).payload(reference.message, count);
  };
  std::string bytes = read(max_bytes);
  // rosbag2 can compress each message; no encapsulation of CDR begins like this.
  if (connection(reference).format == WireFormat::kCdr && bytes.starts_with(kZstdMagic))
    bytes = decompress_zstd(read(std::numeric_limits<std::uint64_t>::max()), place(reference));
  if (bytes.size() > max_bytes) bytes.resize(max_bytes);
  return bytes;
}

std::string BagFile::place(const MessageReference& reference) const {
  return files_[reference.file].path.string() + ":" + connection(reference).topic + " at " +
         eval::format_stamp(reference.message.t) + " s";
}

std::uint64_t BagFile::state() const {
  std::uint64_t hash = 0;
  for (const File& file : files_) {
    const FileState state = file_state(file.path).value_or(FileState{});
    hash = content_hash(std::to_string(state.size) + " " + std::to_string(state.modified_ns) + " " +
                            std::to_string(state.inode),
                        hash);
  }
  return hash;
}

std::vector<MessageReference> in_file_order(std::span<const MessageReference> messages) {
  std::vector<MessageReference> sorted(messages.begin(), messages.end());
  std::ranges::sort(sorted, {}, [](const MessageReference& reference) {
    return std::tuple(reference.file, reference.message.chunk, reference.message.offset);
  });
  return sorted;
}

BagWriter::BagWriter(const fs::path& path, ChunkCompression compression) {
  if (path.extension() == ".bag") {
    require_compression(path, compression != ChunkCompression::kZstd, "none, bz2, lz4");
    writer_ = std::make_unique<Ros1Writer>(path, compression);
  } else if (path.extension() == ".mcap") {
    require_compression(path, compression != ChunkCompression::kBz2, "none, lz4, zstd");
    writer_ = std::make_unique<McapWriter>(path, compression);
  } else {
    require_compression(path, compression == ChunkCompression::kNone, "none");
    writer_ = std::make_unique<Rosbag2Writer>(path);
  }
}

WireFormat BagWriter::format() const {
  return std::holds_alternative<std::unique_ptr<Ros1Writer>>(writer_) ? WireFormat::kRos1 : WireFormat::kCdr;
}

std::uint32_t BagWriter::add_connection(std::string_view topic, std::string_view type) {
  return std::visit([&](auto& writer) { return writer->add_connection(topic, type); }, writer_);
}

void BagWriter::write(std::uint32_t connection, Timestamp t, std::string_view bytes) {
  std::visit([&](auto& writer) { writer->write(connection, t, bytes); }, writer_);
}

void BagWriter::finish() {
  std::visit([](auto& writer) { writer->finish(); }, writer_);
}

}  // namespace stillpoint::datasets
