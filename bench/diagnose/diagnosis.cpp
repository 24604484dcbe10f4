// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/diagnosis.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "bench/diagnose/evidence/depth_alignment.h"
#include "bench/diagnose/image_causes.h"
#include "bench/diagnose/inertial_causes.h"
#include "bench/diagnose/run_causes.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr double kLeastEffect = 0.1;     ///< reduction of the error that counts
constexpr double kChance = 2.5;          ///< standard deviations of the logarithm of an error by chance
constexpr double kLargeEffect = 0.5;     ///< ratio of errors that is an effect if all runs show it
constexpr double kTrialsPerRound = 3.0;  ///< at least: without changes, without IMU, with one correction
constexpr double kFirstTrial = 0.25;     ///< of the budget: leaves time for those of a round
constexpr std::size_t kMaxRounds = 3;    ///< number of faults at once

constexpr std::size_t kLeastFrames = 30;

/// The part of the recording and the measure of its errors.
/// @throws InputError if it has too few frames
TrialRequest request_of(const datasets::SensorStream& stream, const DiagnosisOptions& options) {
  const std::vector<Timestamp>& times = stream.info().frame_times;
  if (times.size() < kLeastFrames)
    throw InputError(
        stream.info().folder.string(),
        fmt::format(
            "has {} frames (from --start on), a diagnosis requires {}; record longer, or start earlier",
            times.size(), kLeastFrames));
  const Timestamp end = after(times.front(), options.length_s);
  const auto count = static_cast<std::size_t>(std::ranges::upper_bound(times, end) - times.begin());
  const bool has_truth = !stream.info().ground_truth.trajectory.poses.empty();
  return {.config = options.config,
          .part = {.count = std::max(count, kLeastFrames)},
          .measure = has_truth ? ErrorMeasure::kTruth : ErrorMeasure::kInconsistency,
          .stop_requested = options.stop_requested};
}

bool is_center(const Cause& cause) { return cause.id == "center"; }

class Diagnoser {
 public:
  Diagnoser(const datasets::SensorStream& stream, const DiagnosisOptions& options)
      : stream_(stream),
        options_(options),
        start_(std::chrono::steady_clock::now()),
        request_(request_of(stream, options)),
        deadline_s_(kFirstTrial * options.budget_s) {
    request_.stop_requested = [this] { return stopped() || elapsed_s() > deadline_s_; };
    const std::vector<Timestamp>& times = stream.info().frame_times;
    diagnosis_.sequence = stream.info().name;
    planned_s_ = seconds_between(times.front(), times[request_.part.count - 1]);
    diagnosis_.measure = request_.measure;
  }

  [[nodiscard]] Diagnosis finish() {
    for (std::size_t round = 0; round < kMaxRounds && !stopped(); ++round) {
      if (!find_next(round)) break;
    }
    std::ranges::stable_sort(diagnosis_.causes, {}, [](const Cause& cause) { return *cause.error_ratio; });
    rank_others(diagnosis_.others, effective_ratio());
    diagnosis_.frames = request_.part.count;
    diagnosis_.seconds = part_s();
    const auto waiting = std::ranges::count_if(diagnosis_.others, [this](const Cause& cause) {
      return cause.correction.has_value() && !cause.error_ratio && !is_circular(cause);
    });
    if (spent_ && waiting > 0) leave_out(fmt::format("the effects of {} candidate(s)", waiting));
    diagnosis_.interrupted = stopped();
    diagnosis_.least_effect = 1.0 - effective_ratio();
    return std::move(diagnosis_);
  }

 private:
  /// By the user.
  [[nodiscard]] bool stopped() const { return options_.stop_requested && options_.stop_requested(); }
  [[nodiscard]] double elapsed_s() const {
    if (options_.elapsed_s) return options_.elapsed_s();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  void announce(const std::string& step) const {
    if (options_.on_step) options_.on_step(step);
  }

  /// The largest ratio of errors that is an effect: chance is estimated from the pairs of all trials.
  [[nodiscard]] double effective_ratio() const {
    double squares = 0.0;
    for (const double difference : differences_) squares += 0.5 * difference * difference;
    const double sigma =
        differences_.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(differences_.size()));
    return std::clamp(std::exp(-kChance * sigma), kLargeEffect, 1.0 - kLeastEffect);
  }

  [[nodiscard]] double part_s() const {
    const std::vector<Timestamp>& times = stream_.info().frame_times;
    return seconds_between(times.front(), times[request_.part.count - 1]);
  }
  /// An interruption is reported as such.
  void leave_out(std::string what) {
    if (!stopped()) diagnosis_.left_out.push_back(std::move(what));
  }

  /// Whether the budget suffices for a number of trials, by those before.
  [[nodiscard]] bool affords(double trials) const {
    const double mean_s = diagnosis_.trials > 0 ? trials_s_ / diagnosis_.trials : 0.0;
    return elapsed_s() + trials * mean_s <= options_.budget_s;
  }

  /// @return nullopt if it was stopped
  [[nodiscard]] std::optional<Trial> trial_with(const std::vector<Correction>& corrections) {
    const double begin_s = elapsed_s();
    Trial trial = run_trial(stream_, request_, corrections);
    if (trial.frames < request_.part.count) return std::nullopt;
    count(trial, elapsed_s() - begin_s);
    return trial;
  }

  void count(const Trial& trial, double duration_s) {
    trials_s_ += duration_s;
    differences_.push_back(trial.difference);
    ++diagnosis_.trials;
  }

  /// The finished run in place of the trial without changes.
  /// @throws InputError if it is too short, or its error cannot be measured
  [[nodiscard]] Trial finished_trial() {
    if (request_.measure == ErrorMeasure::kInconsistency)
      throw InputError("RUN",
                       "has no innovations, which take the place of the error without ground truth; leave it "
                       "out");
    request_.part.count = std::min(request_.part.count, options_.finished->summary.frames);
    if (request_.part.count < kLeastFrames)
      throw InputError("RUN", fmt::format("has {} frames, a diagnosis requires {}; use a longer run",
                                          request_.part.count, kLeastFrames));
    deadline_s_ = options_.budget_s;
    diagnosis_.finished_run = true;
    diagnosis_.foreign = options_.foreign;
    return trial_of(stream_, request_, *options_.finished);
  }

  /// The trial without changes. If it reaches its share of the budget, the part ends there.
  /// @throws InputError if that is too short a part
  [[nodiscard]] Trial first_trial() {
    if (options_.finished) return finished_trial();
    const double begin_s = elapsed_s();
    Trial trial = run_trial(stream_, request_, {});
    deadline_s_ = options_.budget_s;
    if (trial.frames < request_.part.count && !stopped()) {
      if (trial.frames < kLeastFrames)
        throw InputError("--budget",
                         fmt::format("{:.3g} s are too little: a quarter suffices for {} frames, a "
                                     "diagnosis requires {}; increase it",
                                     options_.budget_s, trial.frames, kLeastFrames));
      request_.part.count = trial.frames;
      leave_out(fmt::format("{:.1f} of {:.1f} s of the recording", planned_s_ - part_s(), planned_s_));
    }
    count(trial, elapsed_s() - begin_s);
    return trial;
  }

  /// Candidates of the recording with the corrections that were kept.
  [[nodiscard]] std::vector<Cause> candidates(const RunResult& baseline) {
    const auto part = corrected_part(stream_, request_.part, kept_);
    announce("comparing images with other sensors");
    const Trajectory visual =
        options_.foreign ? baseline.run.trajectory : visual_trajectory(stream_, request_, kept_);
    const RecordingSurvey survey = survey_recording(*part, visual, request_.stop_requested);
    const std::optional<DepthAlignment> alignment = align_depth(*part, request_.stop_requested);
    std::vector<Cause> all;
    if (!options_.foreign) all = run_causes(baseline.run, part->info());
    if (request_.stop_requested()) {  // what is missing would look like a fault
      leave_out("the comparison of images with other sensors");
      spent_ = true;
      return all;
    }
    const TruthReport truth = truth_report(part->info(), survey, visual);
    std::vector<Cause> inertial = inertial_causes(part->info(), survey);
    if (observes_center(baseline.run.calibration)) std::erase_if(inertial, is_center);
    for (const auto& more : {inertial, image_causes(part->info(), survey), truth_causes(truth, part->info()),
                             start_causes(part->info(), survey)})
      all.insert(all.end(), more.begin(), more.end());
    if (alignment) {
      const std::vector<Cause> more = alignment_causes(*alignment);
      all.insert(all.end(), more.begin(), more.end());
    }
    std::ranges::stable_sort(all, std::ranges::greater{}, &Cause::strength);
    erase_consequences(all);
    std::vector<Cause> unique;
    for (Cause& cause : all) {
      if (std::ranges::find(unique, cause.id, &Cause::id) == unique.end()) unique.push_back(std::move(cause));
    }
    return unique;
  }

  /// Measures the effects of all candidates. @return whether a correction was kept
  bool find_next(std::size_t round) {
    announce(fmt::format("running on {} frames", request_.part.count));
    std::optional<Trial> baseline;
    if (round == 0) {
      baseline = first_trial();
      diagnosis_.error = baseline->error;
    } else if (affords(kTrialsPerRound)) {
      baseline = trial_with(kept_);
    }
    if (!baseline) {
      leave_out("the search for causes besides those above");
      list_others(std::move(rest_));
      return false;
    }
    diagnosis_.corrected = baseline->error;
    std::vector<Cause> found = candidates(baseline->result);
    for (std::size_t i = 0; i < found.size() && !stopped(); ++i) {
      announce(fmt::format("candidate {} of {}: {}", i + 1, found.size(), found[i].name));
      measure(found[i], *baseline);
    }
    return keep_best(std::move(found));
  }

  /// The inconsistency is relative to the stated noise: stating more of it reduces it, whatever the noise is.
  [[nodiscard]] bool is_circular(const Cause& cause) const {
    return request_.measure == ErrorMeasure::kInconsistency && cause.id == "imu_noise";
  }

  void measure(Cause& cause, const Trial& baseline) {
    if (!cause.correction) {
      cause.error_ratio = error_ratio_outside(baseline.result, request_.measure, cause.times);
      cause.consistent = cause.error_ratio && is_exceptional(cause, baseline.result);
      return;
    }
    if (options_.foreign || is_circular(cause)) return;
    std::vector<Correction> corrections = kept_;
    corrections.push_back(*cause.correction);
    const std::optional<Trial> trial = affords(1.0) ? trial_with(corrections) : std::nullopt;
    if (!trial) {
      spent_ = true;
      return;
    }
    cause.error_ratio = trial->error / baseline.error;
    // Each run with the correction has a smaller error than each one without.
    cause.consistent =
        std::log(*cause.error_ratio) < -0.5 * (std::abs(trial->difference) + std::abs(baseline.difference));
  }

  /// Whether the errors at the times of a cause are larger than at the same times moved within the recording:
  /// else another second of it would do as well.
  [[nodiscard]] bool is_exceptional(const Cause& cause, const RunResult& result) const {
    constexpr int kShifts = 8;
    const std::vector<Timestamp>& frames = stream_.info().frame_times;
    const Timestamp first = frames[request_.part.first];
    const double length_s = seconds_between(first, frames[request_.part.first + request_.part.count - 1]);
    for (int shift = 1; shift < kShifts; ++shift) {
      std::vector<Timestamp> moved;
      moved.reserve(cause.times.size());
      for (const Timestamp t : cause.times)
        moved.push_back(
            after(first, std::fmod(seconds_between(first, t) + length_s * shift / kShifts, length_s)));
      std::ranges::sort(moved);
      if (error_ratio_outside(result, request_.measure, moved).value_or(1.0) <= *cause.error_ratio)
        return false;
    }
    return true;
  }

  /// The causes of a round go to the lists of the result, the best correction is kept for the next round.
  bool keep_best(std::vector<Cause> found) {
    const double effective = effective_ratio();
    const auto has_effect = [&](const Cause& cause) {
      return cause.consistent && cause.error_ratio &&
             *cause.error_ratio <= std::min(effective, cause.largest_ratio);
    };
    const auto ratio = [&](const Cause& cause) {
      return cause.correction && has_effect(cause) ? *cause.error_ratio : 1.0;
    };
    const auto best = std::ranges::min_element(found, {}, ratio);
    if (best != found.end() && ratio(*best) < 1.0) {
      kept_.push_back(*best->correction);
      diagnosis_.corrected *= *best->error_ratio;
      diagnosis_.causes.push_back(std::move(*best));
      found.erase(best);
      rest_ = std::move(found);
      return true;
    }
    const auto others = std::stable_partition(found.begin(), found.end(), has_effect);
    std::move(found.begin(), others, std::back_inserter(diagnosis_.causes));
    found.erase(found.begin(), others);
    list_others(std::move(found));
    return false;
  }

  void list_others(std::vector<Cause> causes) {
    std::erase_if(causes, [](const Cause& cause) { return cause.needs_effect; });
    std::ranges::move(causes, std::back_inserter(diagnosis_.others));
  }

  const datasets::SensorStream& stream_;
  const DiagnosisOptions& options_;
  std::chrono::steady_clock::time_point start_;
  TrialRequest request_;
  Diagnosis diagnosis_;
  std::vector<Correction> kept_;
  std::vector<Cause> rest_;          ///< candidates of the last round besides the one that was kept
  std::vector<double> differences_;  ///< of the pairs of runs of all trials
  bool spent_ = false;               ///< the budget, before all candidates were measured
  double trials_s_ = 0.0;            ///< time of all trials
  double planned_s_ = 0.0;           ///< duration of the part before it was shortened
  std::atomic<double> deadline_s_;   ///< of what is being done; read by the runs of a trial
};

}  // namespace

void erase_consequences(std::vector<Cause>& causes) {
  const auto is_fundamental = [](const Cause& cause) { return cause.strength >= kFundamental; };
  if (std::ranges::none_of(causes, is_fundamental)) return;
  std::erase_if(causes, [&](const Cause& cause) {
    return !is_fundamental(cause) && cause.basis != CauseBasis::kShown;
  });
}

void rank_others(std::vector<Cause>& causes, double effective) {
  std::ranges::stable_sort(causes, {}, [effective](const Cause& cause) {
    if (cause.is_certain()) return std::tuple(false, CauseBasis::kShown, 0.0);
    return std::tuple(cause.is_refuted(effective), cause.basis, cause.error_ratio.value_or(1.0));
  });
}

Diagnosis diagnose(const datasets::SensorStream& stream, const DiagnosisOptions& options) {
  return Diagnoser(stream, options).finish();
}

Diagnosis refused_recording(const std::string& sequence, const datasets::SensorRangeError& error) {
  const datasets::SensorRange& range = error.range();
  const bool gyro = range.quantity == datasets::kGyroscopeRange.quantity;
  Diagnosis diagnosis{.sequence = sequence, .refused = true};
  diagnosis.others.push_back(
      {.id = gyro ? "gyro_unit" : "accel_unit",
       .name = fmt::format("{} in {}, or defective values", gyro ? "gyroscope" : "accelerometer",
                           range.likely_unit),
       .evidence = error.what(),
       .remedy = fmt::format("convert the values of the file to {} (times {}), or remove the rows",
                             range.unit, gyro ? "0.01745329" : "0.00980665"),
       .strength = kFundamental,
       .basis = CauseBasis::kShown});
  return diagnosis;
}

TruthReport check_truth(const datasets::SensorStream& stream, const DiagnosisOptions& options) {
  const TrialRequest request = request_of(stream, options);
  const Trajectory visual =
      options.finished ? options.finished->trajectory : visual_trajectory(stream, request, {});
  const auto part = corrected_part(stream, request.part, {});
  return truth_report(part->info(), survey_recording(*part, visual, options.stop_requested), visual);
}

}  // namespace stillpoint::bench
