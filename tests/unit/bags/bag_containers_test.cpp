// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>
#include <tuple>
#include <vector>

#include "datasets/bags/bag_chunks.h"
#include "datasets/bags/bag_file.h"
#include "datasets/io/byte_stream.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

constexpr int kMessages = 40;

/// 60 kB that do not compress to nothing, different for each message.
std::string make_content(int index) {
  std::string bytes(60'000, '\0');
  std::uint32_t state = static_cast<std::uint32_t>(index) + 1;
  for (char& byte : bytes) {
    state = state * 1664525 + 1013904223;
    byte = static_cast<char>(state >> 28);
  }
  return bytes;
}

const std::string& content(int index) {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> contents;
    for (int i = 0; i < kMessages; ++i) contents.push_back(make_content(i));
    return contents;
  }();
  return all[static_cast<std::size_t>(index)];
}

/// Messages of 2 topics, the second with two connections, recorded in an order that is not that of time.
std::filesystem::path write_bag(const TemporaryFolder& folder, const std::string& name,
                                ChunkCompression compression) {
  const std::filesystem::path path = folder.path() / name;
  BagWriter writer(path, compression);
  const std::uint32_t image = writer.add_connection("/image", "sensor_msgs/Image");
  const std::uint32_t imu = writer.add_connection("/imu", "sensor_msgs/Imu");
  const std::uint32_t other = writer.add_connection("/imu", "sensor_msgs/Imu");
  for (int i = 0; i < kMessages; ++i) {
    const Timestamp t{(100 + (i ^ 1)) * std::int64_t{1'000'000'007}};
    writer.write(i % 4 == 0 ? image : i % 4 == 1 ? imu : other, t, content(i));
  }
  writer.finish();
  return path;
}

/// Expects the messages of `write_bag`, of which the file may contain the first `count` only.
void expect_content(const BagFile& bag, int count = kMessages) {
  ASSERT_EQ(bag.messages().size(), static_cast<std::size_t>(count));
  for (std::size_t i = 1; i < bag.messages().size(); ++i)
    EXPECT_LE(bag.messages()[i - 1].message.t, bag.messages()[i].message.t);
  for (const MessageReference& reference : bag.messages()) {
    const int index = static_cast<int>(reference.message.t.ns / 1'000'000'007 - 100) ^ 1;
    EXPECT_EQ(bag.payload(reference), content(index)) << index;
    EXPECT_EQ(bag.payload(reference, 10), content(index).substr(0, 10));
    EXPECT_EQ(bag.connection(reference).topic, index % 4 == 0 ? "/image" : "/imu");
    EXPECT_EQ(bag.connection(reference).type, index % 4 == 0 ? "sensor_msgs/Image" : "sensor_msgs/Imu");
  }
}

std::string file_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class BagContainers : public testing::TestWithParam<std::tuple<const char*, ChunkCompression>> {};

TEST_P(BagContainers, WrittenMessagesAreReadBack) {
  const TemporaryFolder folder;
  const BagFile bag(write_bag(folder, std::get<0>(GetParam()), std::get<1>(GetParam())));
  EXPECT_TRUE(bag.warnings().empty());
  expect_content(bag);
}

INSTANTIATE_TEST_SUITE_P(All, BagContainers,
                         testing::Values(std::tuple("a.bag", ChunkCompression::kNone),
                                         std::tuple("a.bag", ChunkCompression::kBz2),
                                         std::tuple("a.bag", ChunkCompression::kLz4),
                                         std::tuple("a.mcap", ChunkCompression::kNone),
                                         std::tuple("a.mcap", ChunkCompression::kLz4),
                                         std::tuple("a.mcap", ChunkCompression::kZstd),
                                         std::tuple("rosbag2", ChunkCompression::kNone)));

TEST(BagContainers, AnInterruptedRos1BagIsReadUpToItsLastCompleteChunk) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_bag(folder, "a.bag", ChunkCompression::kLz4);
  // Chunks are closed above 768 kB, that is, after 14 messages of 60 kB; the second ends before 28.
  std::filesystem::resize_file(path, std::filesystem::file_size(path) * 8 / 10);
  const BagFile bag(path);
  expect_content(bag, 28);
  ASSERT_EQ(bag.warnings().size(), 1U);
  EXPECT_NE(bag.warnings()[0].find("a.bag: is not complete"), std::string::npos) << bag.warnings()[0];
  EXPECT_FALSE(bag.is_complete());
}

TEST(BagContainers, AnInterruptedMcapFileIsReadUpToItsLastCompleteChunk) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_bag(folder, "a.mcap", ChunkCompression::kZstd);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) * 8 / 10);
  const BagFile bag(path);
  expect_content(bag, 28);
  ASSERT_EQ(bag.warnings().size(), 1U);
}

/// The text of all warnings.
std::string warnings_of(const BagFile& bag) {
  std::string text;
  for (const std::string& warning : bag.warnings()) text += warning + "\n";
  return text;
}

/// Bytes that are left at the end of a file: zeros of a recorder that enlarges files in advance, parts of
/// other files, text.
std::vector<std::string> foreign_bytes() {
  return {std::string(100'000, '\0'), content(7), "<html>error 500: the transfer failed</html>\n",
          std::string(3, '\0')};
}

TEST(BagContainers, ForeignBytesAtTheEndAreIgnored) {
  for (const char* const name : {"a.bag", "a.mcap"}) {
    for (const std::string& tail : foreign_bytes()) {
      const TemporaryFolder folder;
      const std::filesystem::path path = write_bag(folder, name, ChunkCompression::kLz4);
      std::ofstream(path, std::ios::binary | std::ios::app) << tail;
      expect_content(BagFile(path));
    }
  }
}

TEST(BagContainers, ForeignBytesInsteadOfTheEndAreIgnoredWithAWarning) {
  for (const char* const name : {"a.bag", "a.mcap"}) {
    for (const std::string& tail : foreign_bytes()) {
      const TemporaryFolder folder;
      const std::filesystem::path path = write_bag(folder, name, ChunkCompression::kLz4);
      std::filesystem::resize_file(path, std::filesystem::file_size(path) * 8 / 10);
      std::ofstream(path, std::ios::binary | std::ios::app) << tail;
      const BagFile bag(path);
      ASSERT_GE(bag.messages().size(), 28U) << name;
      EXPECT_FALSE(bag.warnings().empty()) << name;
      EXPECT_FALSE(bag.is_complete()) << name;
      for (std::size_t i = 0; i < 28; ++i)
        EXPECT_EQ(bag.payload(in_file_order(bag.messages())[i]), content(static_cast<int>(i)));
    }
  }
}

TEST(BagContainers, ForeignBytesBeforeTheIndexOfRos1AreSkipped) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_bag(folder, "a.bag", ChunkCompression::kLz4);
  const std::string text = file_text(path);
  std::uint64_t index = 0;
  const std::size_t field = text.find("index_pos=") + 10;
  std::memcpy(&index, text.data() + field, sizeof(index));
  for (const std::string& junk : foreign_bytes()) {
    const std::uint64_t moved = index + junk.size();
    std::string changed = text;
    std::memcpy(changed.data() + field, &moved, sizeof(moved));
    std::ofstream(path, std::ios::binary) << changed.insert(index, junk);
    const BagFile bag(path);
    expect_content(bag);
    EXPECT_TRUE(bag.is_complete());
    EXPECT_EQ(warnings_of(bag).find("not closed"), std::string::npos) << warnings_of(bag);
  }
}

TEST(BagContainers, FilesWithoutContentAreCalledSo) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& name, const std::string& text, const std::string& part) {
    expect_input_error([&] { static_cast<void>(BagFile(folder.write(name, text))); }, {name, part});
  };
  for (const char* const name : {"a.bag", "a.mcap", "a.db3"}) {
    expect(name, "", "is empty (0 bytes)");
    expect(name, "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 5\n", "git lfs pull");
    expect(name, std::string(5000, '\0'), "zero bytes");
  }
  for (const char* const name : {"b.bag", "b.mcap"}) {
    const std::string text = file_text(write_bag(folder, name, ChunkCompression::kLz4));
    expect(name, text.substr(0, 6000), "ends before its first message");
    BagWriter(folder.path() / "c.bag", ChunkCompression::kNone).finish();
    expect("c.bag", file_text(folder.path() / "c.bag"), "contains no messages");
  }
}

/// The file without its records for which `remove(op, record)` is true.
template <class Remove>
void remove_mcap_records(const std::filesystem::path& path, const Remove& remove) {
  const std::string text = file_text(path);
  std::string kept = text.substr(0, 8);
  for (std::size_t at = 8; at + 9 < text.size();) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, text.data() + at + 1, sizeof(bytes));
    const std::string record = text.substr(at, 9 + bytes);
    if (!remove(static_cast<int>(text[at]))) kept += record;
    at += record.size();
  }
  std::ofstream(path, std::ios::binary) << kept << text.substr(0, 8);
}

/// The records of a ROS 1 bag after its version line, each with the value of its field "op".
std::vector<std::pair<int, std::string>> ros1_records(const std::string& text) {
  const auto number_at = [&text](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, text.data() + at, sizeof(value));
    return std::size_t{value};
  };
  std::vector<std::pair<int, std::string>> records;
  for (std::size_t at = 13; at < text.size();) {
    const std::size_t header = number_at(at);
    const std::size_t bytes = header + 8 + number_at(at + 4 + header);
    const std::string fields = text.substr(at + 4, header);
    const std::size_t op = fields.find(std::string("\4\0\0\0op=", 7));
    records.emplace_back(fields[op + 7], text.substr(at, bytes));
    at += bytes;
  }
  return records;
}

TEST(BagContainers, Ros1IndexesAreOptionalAndUnknownRecordsAreSkipped) {
  const TemporaryFolder folder;
  for (const ChunkCompression method : {ChunkCompression::kNone, ChunkCompression::kBz2}) {
    const std::filesystem::path path = write_bag(folder, "a.bag", method);
    const std::string text = file_text(path);
    std::string kept = text.substr(0, 13);
    kept += ByteWriter().block(std::string("\4\0\0\0op=\x55", 8)).block("of a later version").bytes();
    for (const auto& [op, record] : ros1_records(text)) {
      if (op == 3 || op == 5) kept += record;  // bag header, chunks
    }
    std::ofstream(path, std::ios::binary) << kept;
    expect_content(BagFile(path));
  }
}

/// Index records follow their chunk; the connections are at the end only.
TEST(BagContainers, Ros1ChunksMayBeInAnyOrder) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_bag(folder, "a.bag", ChunkCompression::kLz4);
  const std::string text = file_text(path);
  std::string header = text.substr(0, 13);
  std::vector<std::string> chunks;
  std::string end;
  for (const auto& [op, record] : ros1_records(text)) {
    if (op == 3) header += record;
    if (op == 5) chunks.emplace_back();
    if (op == 5 || op == 4) chunks.back() += record;
    if (op == 7) end += record;
  }
  ASSERT_EQ(chunks.size(), 3U);
  std::ofstream(path, std::ios::binary) << header << chunks[2] << chunks[0] << chunks[1] << end;
  expect_content(BagFile(path));
}

TEST(BagContainers, McapIndexesAreOptionalAndUnknownRecordsAreSkipped) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_bag(folder, "a.mcap", ChunkCompression::kLz4);
  remove_mcap_records(path, [](int opcode) { return opcode == 7 || opcode == 8 || opcode == 11; });
  std::string text = file_text(path);
  ByteWriter unknown;
  unknown.number(std::uint8_t{0x90}).number(std::uint64_t{5}).append("abcde");
  text.insert(8, unknown.bytes());
  std::ofstream(path, std::ios::binary) << text;
  expect_content(BagFile(path));
}

TEST(BagContainers, McapMessagesMayBeOutsideOfChunks) {
  const TemporaryFolder folder;
  ByteWriter file;
  file.append("\x89MCAP0\r\n");
  const auto record = [&file](std::uint8_t opcode, const std::string& fields) {
    file.number(opcode).number(std::uint64_t{fields.size()}).append(fields);
  };
  record(1, ByteWriter().text("").text("").bytes());
  ByteWriter schema, channel, other, message, foreign;
  record(3, schema.number(std::uint16_t{1}).text("sensor_msgs/msg/Imu").text("ros2idl").block("").take());
  record(4,
         channel.number(std::uint16_t{7}).number(std::uint16_t{1}).text("/imu").text("cdr").block("").take());
  record(4,
         other.number(std::uint16_t{8}).number(std::uint16_t{0}).text("/log").text("json").block("").take());
  record(5, foreign.number(std::uint16_t{8})
                .number(std::uint32_t{0})
                .number(std::uint64_t{1})
                .number(std::uint64_t{1})
                .append("{}")
                .take());
  record(5, message.number(std::uint16_t{7})
                .number(std::uint32_t{0})
                .number(std::uint64_t{42})
                .number(std::uint64_t{40})
                .append("payload")
                .take());
  record(15, ByteWriter().number(std::uint32_t{0}).take());
  const BagFile bag(folder.write("a.mcap", file.bytes()));
  ASSERT_EQ(bag.messages().size(), 1U);
  EXPECT_EQ(bag.messages()[0].message.t.ns, 42);
  EXPECT_EQ(bag.payload(bag.messages()[0]), "payload");
  EXPECT_EQ(bag.connection(bag.messages()[0]).type, "sensor_msgs/Imu");
}

TEST(BagContainers, ADamagedMcapChunkIsFoundByItsChecksum) {
  const TemporaryFolder folder;
  const std::filesystem::path path = write_bag(folder, "a.mcap", ChunkCompression::kLz4);
  std::string text = file_text(path);
  text[5000] = static_cast<char>(text[5000] ^ 1);
  std::ofstream(path, std::ios::binary) << text;
  const BagFile bag(path);
  expect_input_error([&] { static_cast<void>(bag.payload(in_file_order(bag.messages()).front())); },
                     {"a.mcap", "damaged"});
}

TEST(BagContainers, FilesOfOtherKindsAreRejectedWithTheRemedy) {
  const TemporaryFolder folder;
  const auto open = [](const std::filesystem::path& path) { static_cast<void>(BagFile(path)); };
  expect_input_error([&] { open(folder.write("old.bag", "#ROSBAG V1.2\n")); }, {"old.bag", "rosbag fix"});
  expect_input_error([&] { open(folder.write("text.bag", "1 2 3\n")); }, {"text.bag", "not a ROS 1 bag"});
  expect_input_error([&] { open(folder.write("text.mcap", "1 2 3\n")); }, {"text.mcap", "not an MCAP file"});
  expect_input_error([&] { open(folder.write("text.db3", std::string(2000, 'x'))); },
                     {"text.db3", "rosbag2"});
  expect_input_error([&] { open(folder.path() / "none.bag"); }, {"none.bag", "no such file"});
  expect_input_error([&] { open(folder.write("text.txt", "")); }, {"text.txt", "is no bag"});
}

TEST(BagContainers, CompressedMessagesOfRosbag2AreDecompressed) {
  const TemporaryFolder folder;
  BagWriter writer(folder.path() / "zstd", ChunkCompression::kNone);
  const std::uint32_t image = writer.add_connection("/image", "sensor_msgs/Image");
  writer.write(image, Timestamp{5}, compress_chunk(ChunkCompression::kZstd, content(3)));
  writer.finish();
  const BagFile bag(folder.path() / "zstd");
  EXPECT_EQ(bag.payload(bag.messages().front()), content(3));
}

TEST(ChunkCodec, WrongSizesAndDamagedBytesAreRejected) {
  for (const ChunkCompression method :
       {ChunkCompression::kBz2, ChunkCompression::kLz4, ChunkCompression::kZstd}) {
    const std::string bytes = content(1);
    const std::string stored = compress_chunk(method, bytes);
    EXPECT_EQ(decompress_chunk(method, stored, bytes.size(), "x"), bytes);
    const auto decompress = [&](const std::string& part, std::size_t size) {
      static_cast<void>(decompress_chunk(method, part, size, "x"));
    };
    expect_input_error([&] { decompress(stored, bytes.size() - 1); }, {"x", "more decompressed bytes"});
    expect_input_error([&] { decompress(stored, bytes.size() + 1); }, {"x", "fewer decompressed bytes"});
    expect_input_error([&] { decompress(stored.substr(0, stored.size() / 2), bytes.size()); },
                       {"x", "damaged"});
    expect_input_error([&] { decompress("no compressed bytes", bytes.size()); }, {"x", "damaged"});
  }
}

}  // namespace
}  // namespace stillpoint::datasets
