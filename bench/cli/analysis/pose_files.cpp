// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/pose_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/plan/plan_sequences.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "datasets/bags/bag_geometry.h"
#include "eval/io/text_reader.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// The format of --format for the files of a role: "nmea" for all, "gt=nmea" and "est=tum" for one.
std::optional<eval::TrajectoryFormat> format_of(const PoseFilePaths& paths, FileRole role) {
  std::optional<eval::TrajectoryFormat> format;
  for (const std::string& text : paths.formats) {
    const std::size_t equals = text.find('=');
    const std::string which = equals == std::string::npos ? "" : text.substr(0, equals);
    if (!which.empty() && which != "gt" && which != "est")
      throw InputError("--format " + text, "expected FORMAT, gt=FORMAT or est=FORMAT");
    const auto value = enum_of<eval::TrajectoryFormat>("--format", text.substr(equals + 1));
    if (which.empty() || (which == "gt") == (role == FileRole::kTruth)) format = value;
  }
  return format;
}

/// Whether the path names a sequence, not poses: a preset, or a folder other than one of 7-Scenes.
bool is_sequence(const fs::path& path) {
  if (!fs::exists(path)) return !path.has_extension();
  if (!fs::is_directory(path) || eval::is_bag(path)) return false;
  return std::none_of(fs::directory_iterator(path), fs::directory_iterator(),
                      [](const auto& entry) { return entry.path().string().ends_with(".pose.txt"); });
}

/// The ground truth of a sequence, as poses of its camera, which a run estimates.
PoseFile truth_of_sequence(const std::string& name) {
  const std::unique_ptr<datasets::SensorStream> stream =
      find_sequence(resolve_sequence(name), {}, {}, {.when_loaded = true});
  const datasets::GroundTruth& truth = stream->info().ground_truth;
  if (truth.trajectory.poses.empty())
    throw InputError(name, "is a sequence without ground truth; give a file of true poses");
  PoseFile file{
      .path = name,
      .loaded = {.trajectory = eval::move_to_frame(truth.trajectory, truth.T_c_f.inverse(), "camera")}};
  // Poses of the camera are the rows of a file, whose columns may have another order than its format states.
  if (truth.T_c_f.matrix().isIdentity()) file.loaded.order_source = eval::OrderSource::kFormat;
  return file;
}

PoseFile load(const PoseFilePaths& paths, const std::string& named, FileRole role) {
  const std::string of_run = (fs::path(named) / "trajectory.tum").string();
  const std::string path = fs::exists(of_run) ? of_run : named;
  eval::TrajectorySource source{.path = path, .times = paths.times, .sequence = paths.sequence};
  source.format = format_of(paths, role);
  if (const std::optional<datasets::BagTopic> bag = datasets::parse_bag_topic(path))
    return {.path = path, .loaded = datasets::read_bag_trajectory(*bag)};
  if (role == FileRole::kTruth && !source.format && is_sequence(path)) return truth_of_sequence(path);
  return {.path = path, .loaded = eval::read_trajectory(source)};
}

/// Whether the rows of a file have columns after the pose: most have none, and are not read twice.
bool has_further_columns(const std::string& path) {
  constexpr std::size_t kPoseColumns = 8;
  std::string text(8192, '\0');
  std::ifstream in(path, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  eval::RowReader rows(text, path);
  std::optional<eval::TextRow> row = rows.next();
  if (row && !eval::parse_number(row->fields.front())) row = rows.next();  // names of the columns
  return row && row->fields.size() > kPoseColumns;
}

/// The covariances of an estimate: of --covariance, of the messages of a bag, or of further columns.
std::optional<eval::CovarianceTable> covariances_of(const PoseFilePaths& paths, const PoseFile& file) {
  if (!paths.covariance.empty())
    return eval::parse_covariances(eval::read_text_file(paths.covariance), paths.covariance);
  if (const std::optional<datasets::BagTopic> bag = datasets::parse_bag_topic(file.path)) {
    eval::CovarianceTable table{.rows = datasets::read_bag_covariances(*bag), .columns = 36};
    const auto is_given = [](const eval::StampedCovariance& row) { return !row.position.isZero(0.0); };
    if (std::ranges::none_of(table.rows, is_given)) return std::nullopt;
    return table;
  }
  if (!has_further_columns(file.path)) return std::nullopt;
  const std::string text = eval::read_text_file(file.path);
  std::optional<eval::CovarianceTable> table = eval::find_covariances(text, file.path);
  if (!table) {
    if (const auto fault = eval::fault_in_covariances(text, file.path))
      spdlog::warn("{}; the covariances of the file were not evaluated", fault->what());
  } else {
    spdlog::info("{}: the {} columns after the pose are covariances ({})", file.path, table->columns,
                 table->columns == 12 ? "rotation, position" : "position, rotation");
  }
  return table;
}

std::vector<PoseFile> load_estimates(const PoseFilePaths& paths) {
  std::vector<PoseFile> files;
  for (const std::string& path : paths.estimates) {
    files.push_back(load(paths, path, FileRole::kEstimate));
    files.back().covariances = covariances_of(paths, files.back());
  }
  return files;
}

void log_repairs(const PoseFile& file) {
  for (const std::string& repair : eval::repair_texts(file.loaded.repairs))
    spdlog::warn("{}: {}", file.path, repair);
}

const char* order_text(eval::QuaternionOrder order) {
  return order == eval::QuaternionOrder::kXyzw ? "qx qy qz qw" : "qw qx qy qz";
}

void warn_of_assumed_order(const PoseFile& file) {
  if (file.loaded.order_source != eval::OrderSource::kAssumed) return;
  spdlog::warn("{}: no header names the columns; the quaternions were read in the order {}", file.path,
               order_text(file.loaded.order));
}

/// @throws InputError for an option that changes none of the files
void require_used_options(const PoseFilePaths& paths, std::span<const PoseFile> files) {
  const auto is_unused = [&](eval::TrajectoryFormat format) {
    return std::ranges::none_of(files, [&](const PoseFile& file) { return file.loaded.format == format; });
  };
  if (!paths.times.empty() && is_unused(eval::TrajectoryFormat::kKitti)) {
    throw InputError("--times", fmt::format("gives the stamps of KITTI poses, and {} has its own; omit it",
                                            files.back().path));
  }
  if (paths.sequence != 0 && is_unused(eval::TrajectoryFormat::kOpenloris)) {
    throw InputError("--seq", fmt::format("selects a sequence of an OpenLORIS file, which {} is not; omit it",
                                          files.back().path));
  }
}

}  // namespace

PoseFile read_pose_file(const PoseFilePaths& paths, const std::string& path, FileRole role) {
  PoseFile file = load(paths, path, role);
  if (role == FileRole::kEstimate) {
    require_used_options(paths, {&file, 1});
    file.covariances = covariances_of(paths, file);
  }
  log_repairs(file);
  warn_of_assumed_order(file);
  return file;
}

std::vector<PoseFile> read_pose_files(const PoseFilePaths& paths) {
  if (!paths.covariance.empty() && paths.estimates.size() > 1)
    throw InputError("--covariance", "is that of one estimate, but several are given");
  std::future<std::vector<PoseFile>> estimates =
      std::async(std::launch::async, [&] { return load_estimates(paths); });
  std::vector<PoseFile> files{load(paths, paths.ground_truth, FileRole::kTruth)};
  std::ranges::move(estimates.get(), std::back_inserter(files));
  require_used_options(paths, files);
  for (const PoseFile& file : files) log_repairs(file);
  return files;
}

namespace {

eval::QuaternionOrder other(eval::QuaternionOrder order) {
  return order == eval::QuaternionOrder::kXyzw ? eval::QuaternionOrder::kWxyz : eval::QuaternionOrder::kXyzw;
}

/// The file read in the other order of quaternions.
/// @param doubt behind the message of an error
/// @throws InputError if its header or format states the order in which it was read
PoseFile in_other_order(PoseFile file, const eval::OrderFinding& finding, const char* doubt) {
  const eval::QuaternionOrder found = other(file.loaded.order);
  const std::string reason = fmt::format(
      "the quaternions are consistent with those of the other file in the order {}: R.RPE {:.3f} "
      "instead of {:.3f} deg/s",
      order_text(found), finding.corrected_rpe_deg_per_s, finding.rpe_deg_per_s);
  if (file.loaded.order_source != eval::OrderSource::kAssumed) {
    throw InputError(
        file.path,
        fmt::format("{}, but {} states {}; reorder the columns, or name them in a first "
                    "line such as \"# t tx ty tz {}\"{}",
                    reason,
                    file.loaded.order_source == eval::OrderSource::kNamed ? "the header" : "the format",
                    order_text(file.loaded.order), order_text(found), doubt));
  }
  spdlog::warn("{}: {}; read so", file.path, reason);
  file.loaded.trajectory = eval::with_other_order(file.loaded.trajectory, file.loaded.order);
  file.loaded.order = found;
  file.loaded.order_source = eval::OrderSource::kFormat;
  return file;
}

}  // namespace

std::vector<PoseFile> with_consistent_orders(std::vector<PoseFile> files, double offset_s) {
  PoseFile& truth = files.front();
  for (std::size_t i = 1; i < files.size(); ++i) {
    const auto finding = eval::find_quaternion_order(truth.loaded, files[i].loaded, offset_s);
    if (!finding) continue;
    if (finding->gt && i > 1) truth.loaded.order_source = eval::OrderSource::kFormat;  // the first one agrees
    // The quaternions of bags and sequences in another body frame are not read in the other order.
    const char* const doubt = truth.loaded.order_source == eval::OrderSource::kNone
                                  ? "; if this order is right, the orientations of the ground truth are wrong"
                                  : "";
    if (finding->gt) truth = in_other_order(std::move(truth), *finding, "");
    if (finding->est) files[i] = in_other_order(std::move(files[i]), *finding, doubt);
  }
  for (const PoseFile& file : files) warn_of_assumed_order(file);
  return files;
}

}  // namespace stillpoint::bench
