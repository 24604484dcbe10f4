// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/finished_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/run/sequence_playback.h"
#include "bench/config/config_file.h"
#include "bench/model/json_problem.h"
#include "bench/model/run_csv.h"
#include "bench/record/run_environment.h"
#include "bench/run/rig_report.h"
#include "bench/store/find_run.h"
#include "core/base/error.h"
#include "core/types/odometry_update.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::size_t kListedKeys = 3;

/// The files of a run.
struct RunTexts {
  std::string place;  ///< for messages
  std::string manifest{}, result{}, trajectory{}, claims{}, counters{};
};

RunTexts texts_of_folder(const fs::path& folder) {
  if (!fs::is_regular_file(folder / "manifest.json"))
    throw InputError(folder.string(),
                     "is no output folder of `stillpoint run`: it has no manifest.json; a run of a store is "
                     "named by --store FILE and its key");
  RunTexts texts{.place = folder.string()};
  texts.manifest = eval::read_text_file(folder / "manifest.json");
  texts.result = eval::read_text_file(folder / "result.json");
  texts.trajectory = eval::read_text_file(folder / "trajectory.tum");
  texts.claims = eval::read_text_file(folder / "status.csv");
  texts.counters = eval::read_text_file(folder / "counters.csv");
  return texts;
}

RunTexts texts_of_stored(const FinishedRunSource& source) {
  const Store store(source.store);
  const StoredRun run = find_run(store, source.run);
  RunTexts texts{.place = fmt::format("run {}", run.key)};
  texts.manifest = store.manifest(run);
  for (const auto& [kind, text] :
       {std::pair("result", &texts.result), std::pair("trajectory", &texts.trajectory),
        std::pair("claims", &texts.claims), std::pair("counters", &texts.counters)}) {
    *text = store.attachment(run, kind);
    if (text->empty())
      throw InputError(texts.place, fmt::format("its store has no {} of it; run the sequence again", kind));
  }
  return texts;
}

Json parsed_json(const std::string& place, const std::string& text) {
  try {
    return Json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(place, "is no JSON: " + json_problem(error));
  }
}

/// Compares the manifest of a run with the conditions.
class ManifestCheck {
 public:
  ManifestCheck(std::string place, Json manifest)
      : place_(std::move(place)), manifest_(std::move(manifest)) {}

  /// @throws InputError for the first difference
  void require(const RunConditions& conditions) const {
    try {
      require_sequence(conditions);
      require_faults(conditions);
      require_config(conditions.config);
      require_mode();
      warn_of_build();
    } catch (const nlohmann::json::exception& error) {
      throw InputError(place_, "its manifest lacks a member: " + json_problem(error));
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& problem) const { throw InputError(place_, problem); }

  void require_sequence(const RunConditions& conditions) const {
    const Json& sequence = manifest_.at("sequence");
    const Json& checksum = sequence.at("checksum");
    const std::string id = checksum.is_null() ? std::string() : checksum.get<std::string>(),
                      files = sequence_identity(conditions.info, "");
    if (!id.starts_with(files))
      refuse(fmt::format("is a run of {} with other files than {} has (identity {}, here {})",
                         sequence.at("name").get<std::string>(), conditions.info.name,
                         id.empty() ? "unknown" : id, files));
    // Plans append the number of frames and the faults, which are compared below.
    const std::string expected = sequence_identity(conditions.info, conditions.rig_file);
    if (!id.starts_with(expected) || id.substr(expected.size()).starts_with(kRigSuffix))
      refuse("was executed with another calibration; pass the file of its --rig, or none");
  }

  void require_faults(const RunConditions& conditions) const {
    std::vector<std::string> expected;
    for (const datasets::SensorFault& fault : conditions.faults) expected.push_back(fault_text(fault));
    const auto faults = manifest_.at("faults").get<std::vector<std::string>>();
    if (faults != expected)
      refuse(fmt::format("was executed with the faults [{}], here they are [{}]; pass the same by --fault",
                         fmt::join(faults, "; "), fmt::join(expected, "; ")));
  }

  void require_config(const OdometryConfig& config) const {
    const Json& resolved = manifest_.at("config").at("resolved");
    std::vector<std::string> differences;
    for (const auto& [key, value] : config_entries(config)) {
      const Json here = Json::parse(value), there = resolved.value(key, Json(nullptr));
      if (here != there) differences.push_back(fmt::format("{} = {}, here {}", key, there.dump(), value));
    }
    if (differences.empty()) return;
    const std::size_t listed = std::min(kListedKeys, differences.size());
    refuse(fmt::format(
        "was executed with another config: {}{}; pass the same --config, --variant and --set",
        fmt::join(differences.begin(), differences.begin() + static_cast<std::ptrdiff_t>(listed), "; "),
        differences.size() > listed ? "; ..." : ""));
  }

  void require_mode() const {
    if (manifest_.at("mode") == "realtime")
      refuse("was executed in mode realtime, the runs that it is compared with are not; use another one");
    if (!manifest_.at("map").is_null())
      refuse("was located in a map, the runs that it is compared with are not; use another one");
  }

  void warn_of_build() const {
    const auto commit = manifest_.at("build").at("git_commit").get<std::string>();
    if (commit != build_info().git_commit)
      spdlog::warn(
          "{} was executed by build {}, the runs that it is compared with by {}: effects contain "
          "their difference",
          place_, commit.substr(0, 10), build_info().git_commit.substr(0, 10));
  }

  std::string place_;
  Json manifest_;
};

/// @return nullopt for null
template <class Value>
std::optional<Value> value_or_none(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional<Value>(json.get<Value>());
}

Eigen::Vector4d lens_of(const Json& json) {
  return {json.at("focal").get<double>(), json.at("k1").get<double>(), json.at("center_x").get<double>(),
          json.at("center_y").get<double>()};
}

/// The rotation that the start of the run was aligned with; only the report has it.
std::optional<AlignedRotation> aligned_rotation_of(const Json& report) {
  constexpr double kDegree = M_PI / 180.0;
  for (const Json& finding : report) {
    if (!finding.at("parameter").get<std::string>().starts_with("camera rotation")) continue;
    return AlignedRotation{.difference_rad = kDegree * finding.at("difference").get<double>(),
                           .sigma_rad = kDegree * finding.at("sigma").get<double>(),
                           .deviations = finding.at("result") == result_name(RigResult::kDiffers)
                                             ? std::numeric_limits<double>::infinity()
                                             : 0.0};
  }
  return std::nullopt;
}

/// Of the members "calibration" and "rig_report": what `rig_report` requires to find the same differences.
/// @param rig as it was stated to the run
EstimatedCalibration estimated_calibration(const Json& result, const Rig& rig) {
  const Json& json = result.at("calibration");
  const Json& agrees = json.at("agrees_with_rig");
  const auto p = json.at("T_b_c").at("p_m").get<std::array<double, 3>>();
  const auto q = json.at("T_b_c").at("q_xyzw").get<std::array<double, 4>>();
  EstimatedCalibration calibration;
  calibration.rig = rig;
  calibration.time_offset_s = json.at("time_offset_s").get<double>();
  calibration.depth_scale = json.at("depth_scale").get<double>();
  calibration.lens = lens_of(json.at("lens_correction"));
  calibration.T_b_c = {Eigen::Quaterniond(q[3], q[0], q[1], q[2]), {p[0], p[1], p[2]}};
  calibration.time_offset_sigma_s = value_or_none<double>(json.at("time_offset_sigma_s"));
  calibration.depth_scale_sigma = value_or_none<double>(json.at("depth_scale_sigma"));
  calibration.extrinsics_sigma_m = value_or_none<double>(json.at("extrinsics_sigma_m"));
  calibration.extrinsics_sigma_rad = value_or_none<double>(json.at("extrinsics_sigma_rad"));
  if (!json.at("lens_sigma").is_null()) calibration.lens_sigma = lens_of(json.at("lens_sigma"));
  calibration.extrinsics_agree = value_or_none<bool>(agrees.at("extrinsics"));
  calibration.depth_scale_agrees = value_or_none<bool>(agrees.at("depth_scale"));
  calibration.lens_agrees = value_or_none<bool>(agrees.at("lens"));
  calibration.aligned_rotation = aligned_rotation_of(result.at("rig_report"));
  return calibration;
}

/// Claims of the frames, without poses: located, or not.
std::vector<eval::ClaimedPose> claims_of(const RunTexts& texts) {
  std::vector<eval::ClaimedPose> claims;
  for (const FrameClaim& frame : parse_claims(texts.claims, texts.place + ": status.csv")) {
    const bool located = frame.status == status_name(OdometryStatus::kTracking) ||
                         frame.status == status_name(OdometryStatus::kDegraded) ||
                         frame.status == status_name(OdometryStatus::kRelocated);
    claims.push_back({.t = Timestamp{frame.t_ns},
                      .claim = located ? eval::PoseClaim::kLocated : eval::PoseClaim::kNone,
                      .segment = frame.segment});
  }
  return claims;
}

/// Number of the first frames of the recording that the run consists of.
/// @param skipped frames that could not be read
std::size_t frames_of(const RunTexts& texts, const std::vector<eval::ClaimedPose>& claims,
                      std::size_t skipped, const std::vector<Timestamp>& frame_times) {
  if (claims.empty()) throw InputError(texts.place, "has no frames");
  const auto end = std::ranges::upper_bound(frame_times, claims.back().t);
  const auto frames = static_cast<std::size_t>(end - frame_times.begin());
  const bool included = std::ranges::all_of(claims, [&](const eval::ClaimedPose& claim) {
    return std::ranges::binary_search(frame_times, claim.t);
  });
  if (!included || frames != claims.size() + skipped)
    throw InputError(
        texts.place,
        fmt::format("its {} frames are not the first ones of the recording; pass its --start, and "
                    "use a run without --every and --passes",
                    claims.size()));
  return frames;
}

}  // namespace

OdometryRun read_finished_run(const FinishedRunSource& source, const RunConditions& conditions) {
  const RunTexts texts = source.store.empty() ? texts_of_folder(source.run) : texts_of_stored(source);
  ManifestCheck(texts.place, parsed_json(texts.place + ": manifest.json", texts.manifest))
      .require(conditions);
  const Json result = parsed_json(texts.place + ": result.json", texts.result);
  OdometryRun run;
  run.claims = claims_of(texts);
  run.frame_counters = parse_counters(texts.counters, texts.place + ": counters.csv");
  run.trajectory.frame = "camera";
  if (std::ranges::any_of(run.claims, [](const eval::ClaimedPose& claim) {
        return claim.claim == eval::PoseClaim::kLocated && claim.segment == 0;
      }))
    run.trajectory = eval::parse_tum(texts.trajectory, texts.place + ": trajectory.tum", "camera").trajectory;
  try {
    run.calibration = estimated_calibration(result, conditions.info.rig);
    const Json& factors = result.at("imu_health").at("noise_factors");
    run.imu_noise = {.gyro = factors.at("gyro").get<double>(), .accel = factors.at("accel").get<double>()};
    run.summary.frames =
        frames_of(texts, run.claims, result.at("skipped_frames").size(), conditions.info.frame_times);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(texts.place + ": result.json", "lacks a member: " + json_problem(error));
  }
  run.frames_planned = run.summary.frames;
  return run;
}

}  // namespace stillpoint::bench
