// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/diagnosis.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

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

class Diagnoser {
 public:
  Diagnoser(const datasets::SensorStream& stream, const DiagnosisOptions& options)
      : stream_(stream),
        options_(options),
        start_(std::chrono::steady_clock::now()),
        request_(request_of(stream, options)) {
    const std::vector<Timestamp>& times = stream.info().frame_times;
    diagnosis_.sequence = stream.info().name;
    diagnosis_.frames = request_.part.count;
    diagnosis_.seconds = seconds_between(times.front(), times[request_.part.count - 1]);
    diagnosis_.measure = request_.measure;
  }

  [[nodiscard]] Diagnosis finish() {
    for (std::size_t round = 0; round < kMaxRounds && !stopped(); ++round) {
      if (!find_next(round)) break;
    }
    std::ranges::stable_sort(diagnosis_.causes, {}, [](const Cause& cause) { return *cause.error_ratio; });
    diagnosis_.interrupted = stopped();
    diagnosis_.least_effect = 1.0 - effective_ratio();
    return std::move(diagnosis_);
  }

 private:
  [[nodiscard]] bool stopped() const { return options_.stop_requested && options_.stop_requested(); }
  [[nodiscard]] double elapsed_s() const {
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

  [[nodiscard]] Trial trial_with(const std::vector<Correction>& corrections) {
    const double begin_s = elapsed_s();
    Trial trial = run_trial(stream_, request_, corrections);
    trial_s_ = std::max(trial_s_, elapsed_s() - begin_s);
    differences_.push_back(trial.difference);
    ++diagnosis_.trials;
    return trial;
  }

  /// Candidates of the recording with the corrections that were kept.
  [[nodiscard]] std::vector<Cause> candidates(const RunResult& baseline) {
    const auto part = corrected_part(stream_, request_.part, kept_);
    announce("comparing images with other sensors");
    const Trajectory visual = visual_trajectory(stream_, request_, kept_);
    const RecordingSurvey survey = survey_recording(*part, visual, options_.stop_requested);
    const TruthReport truth = truth_report(part->info(), survey, visual);
    std::vector<Cause> all;
    for (const auto& more : {inertial_causes(part->info(), survey), image_causes(part->info(), survey),
                             run_causes(baseline.run, part->info()), truth_causes(truth, part->info())})
      all.insert(all.end(), more.begin(), more.end());
    std::ranges::stable_sort(all, std::ranges::greater{}, &Cause::strength);
    // With wrong units or axes, the other differences are their consequences.
    if (!all.empty() && all.front().strength >= kFundamental)
      std::erase_if(all, [](const Cause& cause) { return cause.strength < kFundamental; });
    std::vector<Cause> unique;
    for (Cause& cause : all) {
      if (std::ranges::find(unique, cause.id, &Cause::id) == unique.end()) unique.push_back(std::move(cause));
    }
    return unique;
  }

  /// Measures the effects of all candidates. @return whether a correction was kept
  bool find_next(std::size_t round) {
    if (round > 0 && elapsed_s() + kTrialsPerRound * trial_s_ > options_.budget_s) {
      diagnosis_.out_of_budget = true;
      return false;
    }
    announce(fmt::format("running on {} frames", request_.part.count));
    const Trial baseline = trial_with(kept_);
    if (round == 0) diagnosis_.error = baseline.error;
    diagnosis_.corrected = baseline.error;
    std::vector<Cause> found = candidates(baseline.result);
    for (std::size_t i = 0; i < found.size() && !stopped(); ++i) {
      announce(fmt::format("candidate {} of {}: {}", i + 1, found.size(), found[i].name));
      measure(found[i], baseline);
    }
    return keep_best(std::move(found));
  }

  void measure(Cause& cause, const Trial& baseline) {
    if (!cause.correction) {
      cause.error_ratio = error_ratio_outside(baseline.result, request_.measure, cause.times);
      cause.consistent = cause.error_ratio && is_exceptional(cause, baseline.result);
      return;
    }
    if (measured_ && elapsed_s() + trial_s_ > options_.budget_s) return;
    measured_ = true;
    std::vector<Correction> corrections = kept_;
    corrections.push_back(*cause.correction);
    const Trial trial = trial_with(corrections);
    cause.error_ratio = trial.error / baseline.error;
    // Each run with the correction has a smaller error than each one without.
    cause.consistent =
        std::log(*cause.error_ratio) < -0.5 * (std::abs(trial.difference) + std::abs(baseline.difference));
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
      return true;
    }
    for (Cause& cause : found) {
      if (!cause.error_ratio) {
        diagnosis_.unmeasured.push_back(std::move(cause));
      } else if (has_effect(cause)) {
        diagnosis_.causes.push_back(std::move(cause));
      } else {
        diagnosis_.harmless.push_back(std::move(cause));
      }
    }
    return false;
  }

  const datasets::SensorStream& stream_;
  const DiagnosisOptions& options_;
  std::chrono::steady_clock::time_point start_;
  TrialRequest request_;
  Diagnosis diagnosis_;
  std::vector<Correction> kept_;
  std::vector<double> differences_;  ///< of the pairs of runs of all trials
  bool measured_ = false;            ///< the effect of a candidate
  double trial_s_ = 0.0;             ///< longest time of a trial
};

}  // namespace

Diagnosis diagnose(const datasets::SensorStream& stream, const DiagnosisOptions& options) {
  return Diagnoser(stream, options).finish();
}

TruthReport check_truth(const datasets::SensorStream& stream, const DiagnosisOptions& options) {
  const TrialRequest request = request_of(stream, options);
  const Trajectory visual = visual_trajectory(stream, request, {});
  const auto part = corrected_part(stream, request.part, {});
  return truth_report(part->info(), survey_recording(*part, visual, options.stop_requested), visual);
}

}  // namespace stillpoint::bench
