// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/openloris_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>

#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

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

/// Fills an `OpenlorisFile` row by row.
class OpenlorisParser {
 public:
  explicit OpenlorisParser(RepeatedPoses repeated) : repeated_(repeated) { file_.frame = "base_link"; }

  void parse_row(const TextRow& row) {
    if (row.content.find(':') != std::string_view::npos) {
      parse_header(row);
    } else {
      parse_pose_row(row);
    }
  }

  [[nodiscard]] OpenlorisFile finish(const std::string& name) {
    if (builders_.empty()) {
      throw InputError(
          name,
          "has neither rows \"t tx ty tz qx qy qz qw\" nor the \"seq:\" lines of OpenLORIS; is it "
          "a trajectory?");
    }
    for (auto& [number, builder] : builders_) {
      LoadedTrajectory loaded = builder.release();
      file_.repairs.skipped += loaded.repairs.skipped;
      file_.repairs.repeated += loaded.repairs.repeated;
      file_.repairs.reordered += loaded.repairs.reordered;
      loaded.trajectory.frame = file_.frame;
      file_.sequences[number] = std::move(loaded.trajectory);
    }
    return std::move(file_);
  }

 private:
  void parse_header(const TextRow& row) {
    const std::size_t colon = row.content.find(':');
    const std::string key = lower_case_trimmed(row.content.substr(0, colon));
    const std::string value = lower_case_trimmed(row.content.substr(colon + 1));
    if (key == "scene") file_.scene = value;
    if (key == "frame") file_.frame = value;
    if (key != "seq") return;
    int number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || end != value.data() + value.size()) {
      throw row.error("sequence \"" + value + "\" is not a number");
    }
    const auto [entry, is_new] = builders_.try_emplace(number);
    if (!is_new) throw row.error("duplicate sequence " + value + "; expected unique numbers");
    current_ = &entry->second;
  }

  void parse_pose_row(const TextRow& row) {
    if (current_ == nullptr) throw row.error("pose before the first \"seq:\" line");
    if (row.fields.size() < 1 + kPoseColumns) {
      throw row.error("a pose needs 8 numbers, found " + std::to_string(row.fields.size()) +
                      "; expected \"t tx ty tz qx qy qz qw\"");
    }
    const Timestamp t = row.time(0, TimeUnit::kSeconds);
    const std::optional<Pose> pose =
        parse_pose(row, consecutive_columns(row.fields.size() - kPoseColumns, QuaternionOrder::kXyzw));
    if (pose && repeated_ == RepeatedPoses::kDrop && repeats(row.fields.last(kPoseColumns))) {
      ++file_.repeated_poses;
    } else {
      current_->add(row, t, pose);
    }
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

  RepeatedPoses repeated_;
  OpenlorisFile file_;
  std::map<int, TrajectoryBuilder> builders_;  ///< by number of the sequence
  TrajectoryBuilder* current_ = nullptr;       ///< of the sequence of the last "seq:" line
  std::optional<std::array<double, kPoseColumns>> last_pose_;
};

}  // namespace

OpenlorisFile read_openloris(const std::filesystem::path& file, RepeatedPoses repeated) {
  return parse_openloris(read_text_file(file), file.string(), repeated);
}

OpenlorisFile parse_openloris(std::string_view text, const std::string& name, RepeatedPoses repeated) {
  OpenlorisParser parser(repeated);
  RowReader rows(text, name);
  while (const std::optional<TextRow> row = rows.next()) parser.parse_row(*row);
  return parser.finish(name);
}

std::string format_openloris(const OpenlorisFile& file) {
  std::string text = "scene: " + file.scene + "\nframe: " + file.frame + "\n";
  for (const auto& [number, sequence] : file.sequences) {
    text += "\nseq: " + std::to_string(number) + "\n" + format_tum(sequence);
  }
  return text;
}

}  // namespace stillpoint::eval
