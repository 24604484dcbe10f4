// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/openloris_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "eval/io/pose_row.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kPoseColumns = 7;

std::string lower_case_trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return "";
  std::string result(text.substr(begin, text.find_last_not_of(" \t") - begin + 1));
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// Fills an `OpenlorisFile` line by line.
class OpenlorisParser {
 public:
  OpenlorisParser(const std::string& name, RepeatedPoses repeated) : name_(name), repeated_(repeated) {
    file_.frame = "base_link";
  }

  void parse_line(std::string_view line, long line_number) {
    split_fields(line, fields_);
    if (fields_.empty() || fields_.front().front() == '#') return;
    const RowLocation location{name_, line_number};
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos) {
      parse_header(lower_case_trimmed(line.substr(0, colon)), lower_case_trimmed(line.substr(colon + 1)),
                   location);
    } else {
      parse_row(location);
    }
  }

  [[nodiscard]] OpenlorisFile finish() {
    if (file_.sequences.empty()) {
      throw InputError(name_, "no \"seq:\" line found; an OpenLORIS file has one before each sequence");
    }
    return std::move(file_);
  }

 private:
  void parse_header(const std::string& key, const std::string& value, const RowLocation& location) {
    if (key == "scene") file_.scene = value;
    if (key == "frame") file_.frame = value;
    if (key != "seq") return;
    int number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || end != value.data() + value.size()) {
      throw location.error("sequence \"" + value + "\" is not a number");
    }
    const auto [entry, is_new] = file_.sequences.try_emplace(number);
    if (!is_new) throw location.error("duplicate sequence " + value + "; expected unique numbers");
    sequence_ = &entry->second;
  }

  void parse_row(const RowLocation& location) {
    if (sequence_ == nullptr) throw location.error("pose before the first \"seq:\" line");
    if (fields_.size() < 1 + kPoseColumns) {
      throw location.error("a pose needs 8 numbers, found " + std::to_string(fields_.size()) +
                           "; expected \"t tx ty tz qx qy qz qw\"");
    }
    const Timestamp t = require_stamp(fields_.front(), location);
    const std::span<const std::string_view> columns = std::span(fields_).last(kPoseColumns);
    const std::optional<Pose> pose = parse_pose(columns, QuaternionOrder::kXyzw, location);
    if (!pose) {
      ++file_.skipped_rows;
    } else if (repeated_ == RepeatedPoses::kDrop && repeats(columns)) {
      ++file_.repeated_poses;
    } else {
      append(t, *pose, location);
    }
  }

  void append(Timestamp t, const Pose& pose, const RowLocation& location) {
    LoadedTrajectory loaded;
    std::swap(loaded.trajectory, *sequence_);
    append_row(loaded, t, pose, location);
    std::swap(loaded.trajectory, *sequence_);
  }

  /// Whether the pose equals that of the previous row. As in the OpenLORIS tools, the previous row may belong
  /// to the previous sequence.
  [[nodiscard]] bool repeats(std::span<const std::string_view> columns) {
    std::array<double, kPoseColumns> values{};
    for (std::size_t i = 0; i < kPoseColumns; ++i) values[i] = *parse_number(columns[i]);
    const bool same = last_pose_ == values;
    last_pose_ = values;
    return same;
  }

  const std::string& name_;
  RepeatedPoses repeated_;
  OpenlorisFile file_;
  Trajectory* sequence_ = nullptr;
  std::optional<std::array<double, kPoseColumns>> last_pose_;
  std::vector<std::string_view> fields_;
};

}  // namespace

OpenlorisFile read_openloris(const std::filesystem::path& file, RepeatedPoses repeated) {
  return parse_openloris(read_text_file(file), file.string(), repeated);
}

OpenlorisFile parse_openloris(std::string_view text, const std::string& name, RepeatedPoses repeated) {
  OpenlorisParser parser(name, repeated);
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next())
    parser.parse_line(*line, lines.line_number());
  OpenlorisFile file = parser.finish();
  for (auto& [number, sequence] : file.sequences) sequence.frame = file.frame;
  return file;
}

std::string format_openloris(const OpenlorisFile& file) {
  std::string text = "scene: " + file.scene + "\nframe: " + file.frame + "\n";
  for (const auto& [number, sequence] : file.sequences) {
    text += "\nseq: " + std::to_string(number) + "\n" + format_tum(sequence);
  }
  return text;
}

}  // namespace stillpoint::eval
