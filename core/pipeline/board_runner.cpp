// SPDX-License-Identifier: BSD-3-Clause
// The runner on a virtual clock: what `run_realtime` would do on another machine, worked out on one thread.
#include <algorithm>
#include <cmath>
#include <deque>

#include "core/base/error.h"
#include "core/pipeline/board_cores.h"
#include "core/pipeline/runner_parts.h"

namespace stillpoint {
namespace {

using Time = BoardCores::Time;

/// What was found in a picture, and when that is known.
struct BoardDetection {
  DetectionOnWay found;
  Time known_at{};
};

/// What the optimisation said, and from when on that is known.
struct BoardFeedback {
  Feedback feedback;
  Time known_at{};
};

Time cost_of(const StageCost& cost, const ModuleTime& here) {
  if (cost.fixed_ms) return Time(std::llround(1e6 * *cost.fixed_ms));
  return Time(std::llround(cost.factor * static_cast<double>(here.ns)));
}

class BoardRun {
 public:
  BoardRun(const SensorInput& input, const OdometryConfig& config, const RunControl& control,
           const BoardClock& clock)
      : input_(input),
        config_(config),
        control_(control),
        clock_(clock),
        stages_(assemble(input, config)),
        cores_(clock.board.cores),
        imu_of_tracker_(input.imu),
        imu_of_estimator_(input.imu) {
    report_.deadline_ms = 1e3 * median_interval_s(input.frame_times) / clock.speed;
    known_.push_back({stages_.optimization.feedback(), Time{}});
  }

  RunSummary run() {
    while (const std::optional<std::size_t> index = next_picture()) {
      if (control_.stop_requested && control_.stop_requested()) {
        summary_.interrupted = true;
        break;
      }
      std::optional<PictureOnWay> picture = load_picture(input_, *index, summary_.skipped);
      if (picture) process(*picture, exposure(*index));
    }
    summary_.realtime = std::move(report_);
    close_run(stages_, summary_);
    return std::move(summary_);
  }

 private:
  [[nodiscard]] Time exposure(std::size_t index) const {
    const double seconds = seconds_between(input_.frame_times.front(), input_.frame_times[index]);
    return Time(std::llround(1e9 * seconds / clock_.speed));
  }

  /// The picture that the tracker takes next; moves `now_` to that moment.
  std::optional<std::size_t> next_picture() {
    const std::size_t count = input_.frame_times.size();
    if (next_ >= count) return std::nullopt;
    now_ = std::max(now_, exposure(next_));
    std::size_t exposed = next_;
    while (exposed < count && exposure(exposed) <= now_) ++exposed;
    const std::size_t kept = std::min(exposed - next_, kWaitingPictures);
    report_.dropped += static_cast<int>(exposed - next_ - kept);
    next_ = exposed - kept;
    summary_.frames = std::max(summary_.frames, exposed);
    return next_++;
  }

  /// The newest knowledge that is there at this moment.
  [[nodiscard]] const Feedback& known_now() {
    while (known_.size() > 1 && known_[1].known_at <= now_) known_.pop_front();
    return known_.front().feedback;
  }

  void process(PictureOnWay& picture, Time exposed) {
    const Timestamp imu_end = after(picture.frame.t, input_.rig.time_offset_s + kImuLead_s);
    imu_of_tracker_.up_to(imu_end, stages_.tracking);
    imu_of_estimator_.up_to(imu_end, stages_.optimization);
    picture.full = stages_.rate.admits(picture.frame.t);
    picture.tracked = stages_.tracking.process(picture.frame, picture.full, known_now());
    const Time tracked_at =
        cores_.occupy(now_, cost_of(clock_.board.tracking, picture.tracked.timings[Module::kTrackingThread]));
    if (picture.full) detect(picture.frame);
    // One tracked picture waits at most: the tracker goes on when the one before has been taken.
    now_ = std::max(tracked_at, optimization_began_);
    optimize(picture, tracked_at, exposed);
  }

  /// A detector that is busy lets a picture pass.
  void detect(const Frame& frame) {
    if (detector_free_ > now_) return;
    BoardDetection detection{.found = detect_objects(*stages_.detector, frame), .known_at = {}};
    const bool nothing_to_do = config_.detector.kind == DetectorKind::kNone;
    const Time cost = nothing_to_do ? Time{}
                                    : cost_of(clock_.board.detection,
                                              {.ns = detection.found.search->elapsed.count(), .calls = 1});
    detection.known_at = clock_.board.detector_has_own_processor ? now_ + cost : cores_.occupy(now_, cost);
    detector_free_ = detection.known_at;
    detections_.push_back(std::move(detection));
  }

  void optimize(const PictureOnWay& picture, Time ready, Time exposed) {
    Time begin = std::max(ready, optimizer_free_);
    std::optional<DetectionOnWay> found;
    if (picture.full) found = take_detection(picture.frame.t, begin);
    ModuleTime here;
    RunControl control = control_;
    control.on_update = [&](const OdometryUpdate& update) {
      here = update.timings[Module::kOptimizationThread];
      if (control_.on_update) control_.on_update(update);
    };
    close_picture(picture, found, stages_.optimization, control, summary_);
    const bool free = !picture.full && clock_.board.optimization.fixed_ms;
    const Time cost = free ? Time{} : cost_of(clock_.board.optimization, here);
    optimization_began_ = begin;
    optimizer_free_ = cores_.occupy(begin, cost);
    report_.latencies_ms.push_back(1e-6 * static_cast<double>((optimizer_free_ - exposed).count()));
    known_.push_back({stages_.optimization.feedback(), optimizer_free_});
  }

  /// Boxes for a picture, by the rules of `NewestDetections::take`; moves `begin` to the moment when they are
  /// there, or no longer waited for.
  DetectionOnWay take_detection(Timestamp t, Time& begin) {
    const Time limit = begin + Time(std::llround(1e6 * kDetectionWait * report_.deadline_ms));
    const bool own = !detections_.empty() && detections_.back().found.set.t == t;
    begin =
        own && detections_.back().known_at <= limit ? std::max(begin, detections_.back().known_at) : limit;
    std::optional<DetectionOnWay> newest;
    while (!detections_.empty() && detections_.front().known_at <= begin) {
      newest = std::move(detections_.front().found);
      detections_.pop_front();
    }
    const bool usable = newest && seconds_between(newest->set.t, t) <= config_.pipeline.detection_max_age_s;
    if (!usable) newest = {.set = {.t = t, .state = DetectionState::kLate, .detections = {}}, .search = {}};
    report_.late_detections += newest->set.state == DetectionState::kLate;
    return std::move(*newest);
  }

  const SensorInput& input_;
  const OdometryConfig& config_;
  const RunControl& control_;
  const BoardClock& clock_;
  Stages stages_;
  RunSummary summary_;
  RealtimeReport report_;
  BoardCores cores_;
  ImuFeed imu_of_tracker_;
  ImuFeed imu_of_estimator_;
  std::size_t next_ = 0;  ///< picture
  Time now_{};            ///< the tracker's
  Time detector_free_{};
  Time optimizer_free_{};
  Time optimization_began_{};              ///< of the picture before
  std::deque<BoardDetection> detections_;  ///< not taken yet
  std::deque<BoardFeedback> known_;        ///< the first one is known, the others will be
};

}  // namespace

RunSummary run_on_board(const SensorInput& input, const OdometryConfig& config, const RunControl& control,
                        const BoardClock& clock) {
  if (!(clock.speed > 0.0)) throw InputError("--speed", "must be larger than 0; 1 is as recorded");
  if (input.frame_times.empty()) return {};
  return BoardRun(input, config, control, clock).run();
}

}  // namespace stillpoint
