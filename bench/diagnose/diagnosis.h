// SPDX-License-Identifier: BSD-3-Clause
/// What limits the accuracy on a recording, in order: `stillpoint diagnose`.
///
/// Candidate causes come from the data and from a run of the odometry. The effect of each is measured by
/// repeating the run with the fault undone (`Correction`), or, where it cannot be undone, by the error
/// outside of the frames concerned. Then the correction with the largest effect is kept, and all is repeated,
/// so that several faults are found one after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/diagnose/cause.h"
#include "bench/diagnose/trials.h"
#include "bench/diagnose/truth_report.h"
#include "datasets/io/imu_file.h"

namespace stillpoint::bench {

struct DiagnosisOptions {
  ConfigRequest config;
  /// A trial that would end later, by the mean time of those before, is left out, and one that does is
  /// stopped and discarded. If the first trial takes more than a quarter, the part is cut to what it reached.
  double budget_s = 60.0;
  std::function<double()> elapsed_s{};  ///< of the budget; thread-safe; empty: since the call
  /// A finished run of the first frames with the config, in place of the first trial; only with ground truth.
  std::optional<OdometryRun> finished{};
  /// `finished` is of another system, which is not executed: its trajectory takes the place of that without
  /// IMU, causes in this odometry are left out, and effects of corrections are not measured.
  bool foreign = false;
  double length_s = 15.0;                                  ///< of the part of the recording, from its start
  std::function<bool()> stop_requested{};                  ///< thread-safe; may be empty
  std::function<void(const std::string& step)> on_step{};  ///< what is being done; may be empty
};

struct Diagnosis {
  std::string sequence;
  ErrorMeasure measure = ErrorMeasure::kTruth;
  std::size_t frames = 0;     ///< of the part
  double seconds = 0.0;       ///< duration of the part
  double error = 0.0;         ///< as it is
  double corrected = 0.0;     ///< with all corrections that were kept
  double least_effect = 0.1;  ///< relative change of the error that counts: 10 %, or what chance causes
  int trials = 0;
  bool finished_run = false;  ///< `error` is that of the finished run
  bool foreign = false;       ///< which is of another system
  bool refused = false;       ///< it cannot be read, see `refused_recording`
  bool interrupted = false;
  std::vector<std::string> left_out;  ///< for lack of budget, one phrase each
  std::vector<Cause> causes;          ///< with an effect, worst first
  std::vector<Cause> others;  ///< with a smaller effect, or one that was not measured: most likely first
};

/// With wrong units or axes, the other differences between sensors are their consequences, and are left out;
/// what the data itself shows stays.
void erase_consequences(std::vector<Cause>& causes);

/// Orders causes without an effect that counts: those that the data itself shows and wrong axes, as they are;
/// those by comparison of sensors; those inferred from a run; among the last two by the error with their
/// correction, and last those whose correction increases it by more than chance.
/// @param effective ratio of errors that counts, see `Diagnosis::least_effect`
void rank_others(std::vector<Cause>& causes, double effective);

/// @throws InputError as `run_odometry`, for a budget that ends before 30 frames are processed, and for a
/// finished run of fewer frames or without ground truth
[[nodiscard]] Diagnosis diagnose(const datasets::SensorStream& stream, const DiagnosisOptions& options);

/// Of a recording that cannot be read for its inertial values: no frames, and their unit among `others`.
[[nodiscard]] Diagnosis refused_recording(const std::string& sequence,
                                          const datasets::SensorRangeError& error);

/// Only the comparison of the ground truth with the other sensors, by one run without IMU, or by the finished
/// run.
/// @throws InputError for a recording with too few frames
[[nodiscard]] TruthReport check_truth(const datasets::SensorStream& stream, const DiagnosisOptions& options);

}  // namespace stillpoint::bench
