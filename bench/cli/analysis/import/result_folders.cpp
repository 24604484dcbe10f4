// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/import/result_folders.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/analysis/import/imported_runs.h"
#include "bench/model/metrics.h"
#include "bench/model/scale_fit.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/io/experiment_file.h"
#include "eval/compare/conventions.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"
#include "eval/score.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// A trajectory of a result folder.
struct ResultFile {
  std::string system, variant, sequence;
  std::int64_t repetition = 1;
  fs::path estimate;  ///< a file that does not exist is a failed run
  fs::path truth;
  bool has_scale = true;
};

constexpr std::string_view kKeyframes = "_KeyFrameTrajectory.csv";
constexpr std::ptrdiff_t kColumns = 8;  // time, position, quaternion

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder.string(), "is no folder");
  std::vector<fs::path> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
  std::ranges::sort(entries);
  return entries;
}

std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> folders = sorted_entries(folder);
  std::erase_if(folders, [](const fs::path& path) { return !fs::is_directory(path); });
  return folders;
}

std::vector<fs::path> files_in(const fs::path& folder, std::string_view ending) {
  std::vector<fs::path> files = sorted_entries(folder);
  std::erase_if(files, [&](const fs::path& path) {
    return !path.filename().string().ends_with(ending) || !fs::is_regular_file(path);
  });
  return files;
}

/// The last number in the name of a file, nullopt without one or with more than 9 digits.
std::optional<std::int64_t> number_in(const fs::path& file) {
  constexpr std::string_view kDigits = "0123456789";
  const std::string name = file.stem().string();
  const std::size_t last = name.find_last_of(kDigits);
  if (last == std::string::npos) return std::nullopt;
  const std::size_t before = name.find_last_not_of(kDigits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(name.data() + first, name.data() + last + 1, number);
  if (error != std::errc{} || last - first >= 9) return std::nullopt;
  return number;
}

/// Repetitions of one system: as the files are numbered, so that a file that is added later does not change
/// them; in the order of their names if some have no number, or two have the same one.
std::vector<std::pair<std::int64_t, fs::path>> numbered(const std::vector<fs::path>& files) {
  std::vector<std::pair<std::int64_t, fs::path>> by_number, by_name;
  std::set<std::int64_t> numbers;
  for (const fs::path& file : files) {
    by_name.emplace_back(static_cast<std::int64_t>(by_name.size()) + 1, file);
    if (const std::optional<std::int64_t> number = number_in(file)) {
      by_number.emplace_back(*number, file);
      numbers.insert(*number);
    }
  }
  return numbers.size() == files.size() ? by_number : by_name;
}

std::vector<ResultFile> ov_eval_files(const ResultSource& source) {
  const fs::path beside = source.path / (fs::exists(source.path / "truths") ? "truths" : "truth");
  const fs::path truths = source.truth.empty() ? beside : source.truth;
  std::vector<ResultFile> files;
  for (const fs::path& system : folders_in(source.path / "algorithms")) {
    for (const fs::path& sequence : folders_in(system)) {
      for (const auto& [repetition, run] : numbered(files_in(sequence, ".txt")))
        files.push_back({.system = system.filename().string(),
                         .variant = system.filename().string(),
                         .sequence = sequence.filename().string(),
                         .repetition = repetition,
                         .estimate = run,
                         .truth = truths / (sequence.filename().string() + ".txt")});
    }
  }
  return files;
}

std::vector<ResultFile> evalio_files(const ResultSource& source) {
  std::vector<ResultFile> files;
  for (const fs::path& dataset : folders_in(source.path)) {
    for (const fs::path& sequence : folders_in(dataset)) {
      const fs::path name = dataset.filename() / sequence.filename();
      for (const fs::path& run : files_in(sequence, ".csv")) {
        const std::string pipeline = run.stem().string();
        if (pipeline == "gt") continue;
        files.push_back({.system = pipeline.substr(0, pipeline.find("__")),
                         .variant = pipeline,
                         .sequence = name.string(),
                         .estimate = run,
                         .truth = (source.truth.empty() ? source.path : source.truth) / name / "gt.csv"});
      }
    }
  }
  return files;
}

/// The folder in `parent` that is named like a dataset, without regard to case and signs between the words.
fs::path dataset_folder(const fs::path& parent, const std::string& dataset) {
  const auto plain = [](const std::string& name) {
    std::string letters;
    for (const unsigned char letter : name) {
      if (std::isalnum(letter) != 0) letters += static_cast<char>(std::tolower(letter));
    }
    return letters;
  };
  if (fs::is_directory(parent)) {
    for (const fs::path& folder : folders_in(parent)) {
      if (plain(folder.filename().string()) == plain(dataset)) return folder;
    }
  }
  return parent / dataset;
}

const fs::path& required_truth(const ResultSource& source) {
  if (source.truth.empty())
    throw InputError(source.path.string(),
                     "is of VSLAM-LAB, whose ground truths are elsewhere; pass --truth FOLDER, its "
                     "benchmark folder");
  return source.truth;
}

/// VSLAM-LAB numbers from 0 on.
/// @throws InputError if the name of the file does not begin with a number
std::int64_t vslam_lab_repetition(const fs::path& run) {
  std::string number = run.filename().string();
  number.resize(number.size() - kKeyframes.size());
  if (number.find_first_not_of("0123456789") == std::string::npos) {
    if (const std::optional<std::int64_t> value = number_in(number)) return *value + 1;
  }
  throw InputError(run.string(), fmt::format("is not named NUMBER{} as the runs of VSLAM-LAB, such as "
                                             "00000{}; rename it",
                                             kKeyframes, kKeyframes));
}

/// Of the folder of one experiment, without its file.
std::vector<ResultFile> vslam_lab_files(const ResultSource& source) {
  const std::string name =
      fs::absolute(source.path / "").lexically_normal().parent_path().filename().string();
  std::vector<ResultFile> files;
  for (const fs::path& dataset : folders_in(source.path)) {
    const fs::path truths = dataset_folder(required_truth(source), dataset.filename().string());
    for (const fs::path& sequence : folders_in(dataset)) {
      for (const fs::path& run : files_in(sequence, kKeyframes))
        files.push_back({.system = source.system.empty() ? name : source.system,
                         .variant = name,
                         .sequence = (truths.filename() / sequence.filename()).string(),
                         .repetition = vslam_lab_repetition(run),
                         .estimate = run,
                         .truth = truths / sequence.filename() / "groundtruth.csv"});
    }
  }
  return files;
}

std::vector<ResultFile> experiment_files(const ResultSource& source) {
  if (!fs::is_directory(source.results))
    throw InputError(source.path.string(),
                     "is an experiment file; pass --results FOLDER, the evaluation folder of VSLAM-LAB");
  std::vector<ResultFile> files;
  for (const datasets::Experiment& experiment : datasets::read_experiments(source.path)) {
    if (!fs::is_directory(source.results / experiment.name))
      throw InputError((source.results / experiment.name).string(),
                       "does not exist: the experiment was not executed, or its results are elsewhere; "
                       "correct --results, or remove the experiment from " +
                           source.path.string());
    for (const datasets::ExperimentSequence& entry : experiment.sequences) {
      const fs::path runs = dataset_folder(source.results / experiment.name, entry.dataset) / entry.sequence;
      const fs::path truths = dataset_folder(required_truth(source), entry.dataset);
      for (int run = 0; run < experiment.runs; ++run)
        files.push_back({.system = experiment.system,
                         .variant = experiment.name,
                         .sequence = (truths.filename() / entry.sequence).string(),
                         .repetition = run + 1,
                         .estimate = runs / fmt::format("{:05}{}", run, kKeyframes),
                         .truth = truths / entry.sequence / "groundtruth.csv",
                         .has_scale = experiment.mode != "mono"});
    }
  }
  return files;
}

std::vector<ResultFile> files_of(const ResultSource& source) {
  const bool is_file = !fs::is_directory(source.path);
  const bool is_vslam_lab = !is_file && fs::exists(source.path / "vslamlab_exp_log.csv");
  if (!source.system.empty() && !is_vslam_lab)
    throw InputError("--system", "has no effect: the systems are named by " + source.path.string());
  if (!source.results.empty() && !is_file)
    throw InputError("--results", "has no effect without an experiment file");
  if (source.fit_scale && is_file)
    throw InputError("--fit-scale",
                     "has no effect: \"mode\" of the experiments tells whether they have a scale");
  if (is_file) return experiment_files(source);
  if (fs::is_directory(source.path / "algorithms")) return ov_eval_files(source);
  return is_vslam_lab ? vslam_lab_files(source) : evalio_files(source);
}

/// Whether a system wrote no pose: there are only blank lines, comments and a header. What else is there is
/// for the reader of trajectories.
bool is_without_poses(const std::string& text) {
  std::istringstream lines(text);
  bool has_header = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const bool is_header = std::isalpha(static_cast<unsigned char>(line[first])) != 0 &&
                           std::ranges::count(line, ',') == kColumns - 1;
    if (has_header || !is_header) return false;
    has_header = true;
  }
  return true;
}

/// The ground truths of sequences, each read once.
class GroundTruths {
 public:
  struct Truth {
    Trajectory trajectory;
    std::string hash;  ///< of the file
  };

  /// @throws InputError if it does not exist or is malformed
  const Truth& of(const ResultFile& file) {
    const auto known = truths_.find(file.truth);
    if (known != truths_.end()) return known->second;
    if (!fs::exists(file.truth))
      throw InputError(file.truth.string(),
                       "does not exist; it is the ground truth of " + file.sequence + ", see --truth");
    return truths_[file.truth] = {.trajectory = eval::read_trajectory({.path = file.truth}).trajectory,
                                  .hash = hash_text(content_hash(eval::read_text_file(file.truth)))};
  }

 private:
  std::map<fs::path, Truth> truths_;
};

/// @throws InputError for a malformed file, or without a pose at the time of one of the ground truth
RunOutcome scored(const ResultFile& file, const Trajectory& truth) {
  if (!fs::exists(file.estimate)) return {.outcome = Outcome::kLost, .detail = "wrote no trajectory"};
  if (is_without_poses(eval::read_text_file(file.estimate)))
    return {.outcome = Outcome::kLost, .detail = "wrote a trajectory without poses"};
  Trajectory estimate = eval::read_trajectory({.path = file.estimate}).trajectory;
  if (!file.has_scale) fit_scale(estimate, truth);
  const eval::Score score = eval::score(truth, estimate);
  if (!score.ate)
    throw InputError(file.estimate.string(),
                     "has no pose at the time of one of " + file.truth.string() + ", its ground truth");
  if (file.has_scale && eval::find_wrong_scale(truth, estimate)) {
    Trajectory scaled = estimate;
    spdlog::warn(
        "{}: the estimate is {:.3g} times as large as the ground truth, and scored as it is; if its system "
        "has no scale (monocular), import into another store with --fit-scale",
        file.estimate.string(), 1.0 / fit_scale(scaled, truth));
  }
  RunOutcome outcome{.detail = eval::sparse_truth_doubt(truth, score)};
  outcome.metrics =
      measured_metrics({.scored = ScoredTrajectory{.gt = truth, .est = estimate, .score = score}});
  if (!file.has_scale) state_fitted_scale(outcome.metrics);
  outcome.attachments = {{"trajectory", eval::format_tum(estimate)}, {"truth", eval::format_tum(truth)}};
  return outcome;
}

}  // namespace

bool is_result_source(const fs::path& path) {
  return fs::is_directory(path) || path.extension() == ".yaml" || path.extension() == ".yml";
}

MergeReport import_results(const ResultSource& source, const fs::path& store) {
  GroundTruths truths;
  std::vector<ImportedRun> runs;
  for (ResultFile& file : files_of(source)) {
    if (source.fit_scale) file.has_scale = false;
    const GroundTruths::Truth& truth = truths.of(file);
    RunIdentity identity = imported_identity();
    identity.system = file.system;
    identity.variant = file.variant;
    identity.sequence = file.sequence;
    identity.sequence_id = "truth-" + hash_text(content_hash(file.sequence + "\n" + truth.hash));
    identity.config_hash = hash_text(content_hash(file.variant));
    identity.repetition = file.repetition;
    runs.push_back({std::move(identity), scored(file, truth.trajectory)});
  }
  if (runs.empty())
    throw InputError(source.path.string(),
                     "has no trajectories in the layout of ov_eval (algorithms/SYSTEM/SEQUENCE/RUN.txt), "
                     "evalio (DATASET/SEQUENCE/PIPELINE.csv) or VSLAM-LAB "
                     "(DATASET/SEQUENCE/00000_KeyFrameTrajectory.csv and vslamlab_exp_log.csv)");
  return add_imported(store, runs);
}

}  // namespace stillpoint::bench
