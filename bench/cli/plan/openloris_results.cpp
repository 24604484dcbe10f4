// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/plan/openloris_results.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <memory>
#include <optional>

#include "bench/record/output_folder.h"
#include "datasets/open_sequence.h"
#include "eval/io/openloris_file.h"
#include "eval/openloris/benchmark.h"
#include "eval/trajectory/alignment.h"
#include "reports/drawing/drawing_file.h"
#include "reports/drawing/openloris_figure.h"
#include "reports/text/evaluation_table.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "openloris_";
/// Estimates and ground truth are written in the frame of the color camera; the calibration of each package
/// relates it to the recorded frame.
constexpr const char* kFrame = "d400_color";

/// "openloris_cafe1-2" -> cafe, 2.
struct SceneSequence {
  std::string scene;
  int number = 0;
};

std::optional<SceneSequence> scene_sequence(const std::string& name) {
  if (!name.starts_with(kPrefix)) return std::nullopt;
  const std::string rest = name.substr(kPrefix.size());
  const auto digit = std::ranges::find_if(rest, [](unsigned char c) { return std::isdigit(c) != 0; });
  const std::size_t dash = rest.find('-');
  if (digit == rest.end() || dash == std::string::npos) return std::nullopt;
  SceneSequence result{.scene = std::string(rest.begin(), digit)};
  const char* const end = rest.data() + rest.size();
  if (std::from_chars(rest.data() + dash + 1, end, result.number).ptr != end) return std::nullopt;
  return result;
}

/// Writes the ground truth of each scene. @return number of sequences
std::size_t write_ground_truth(const PlanMatrix& matrix, const fs::path& folder) {
  std::map<std::string, eval::OpenlorisFile> scenes;
  std::size_t count = 0;
  for (const PlanSequence& sequence : matrix.sequences) {
    const std::optional<SceneSequence> place = scene_sequence(sequence.name);
    if (!place || !sequence.unavailable_reason.empty()) continue;
    const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(sequence.folder);
    const datasets::GroundTruth& truth = stream->info().ground_truth;
    if (truth.trajectory.poses.empty()) continue;
    eval::OpenlorisFile& scene = scenes[place->scene];
    scene.scene = place->scene;
    scene.frame = kFrame;
    scene.sequences[place->number] = eval::move_to_frame(truth.trajectory, truth.T_c_f.inverse(), kFrame);
    ++count;
  }
  for (const auto& [name, scene] : scenes)
    write_files(folder, {{"gt_" + name + "_1.txt", eval::format_openloris(scene)}});
  return count;
}

/// Writes one file per completed run. @return their number
std::size_t write_results(const PlanMatrix& matrix, const Store& store, const fs::path& folder) {
  std::size_t count = 0;
  for (const StoredRun& run : store.plan_runs(matrix.plan.name)) {
    const std::optional<SceneSequence> place = scene_sequence(run.identity.sequence);
    if (!place || !run.blobs.contains("trajectory")) continue;
    Trajectory estimate = store.trajectory(run);
    if (estimate.poses.empty()) continue;
    eval::OpenlorisFile file{.scene = place->scene, .frame = kFrame};
    file.sequences.emplace(place->number, std::move(estimate));
    write_files(folder / folder_name(run.identity.variant),
                {{run.identity.sequence + ".txt", eval::format_openloris(file)}});
    ++count;
  }
  return count;
}

}  // namespace

std::string openloris_scene_table(const PlanMatrix& matrix, const Store& store, const fs::path& out) {
  const fs::path folder = out / "openloris";
  fs::remove_all(folder / "results");
  fs::remove_all(folder / "ground_truth");
  const std::size_t truths = write_ground_truth(matrix, folder / "ground_truth");
  if (truths == 0 || write_results(matrix, store, folder / "results") == 0) return "";
  const eval::OpenlorisEvaluation evaluation =
      eval::evaluate_openloris(folder / "results", folder / "ground_truth");
  report::write_drawing(out / "openloris_figure.svg", report::openloris_figure(evaluation.benchmark), 1.0,
                        {.force = true});
  return report::openloris_table(evaluation.benchmark, report::TableStyle::kMarkdown);
}

}  // namespace stillpoint::bench
