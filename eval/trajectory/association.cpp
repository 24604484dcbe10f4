// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/association.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <queue>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::vector<Timestamp> timestamps_of(const Trajectory& trajectory) {
  std::vector<Timestamp> stamps;
  stamps.reserve(trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) stamps.push_back(pose.t);
  return stamps;
}

/// A stamp of either list on the common time axis. Unmatched ones form a doubly linked list.
struct Event {
  std::size_t index;
  bool is_gt;
  std::size_t previous;
  std::size_t next;
  bool matched = false;
};

/// Neighbors on the time axis, one of each list.
struct Candidate {
  double difference_s;
  std::size_t left;  ///< event indices
  std::size_t right;
};

/// Greedy matching by time difference. The closest unmatched pair always consists of neighbors on the time
/// axis, because anything between them would be closer to one of the two. A heap of neighbors therefore
/// suffices, and removing a pair creates at most one new pair of neighbors.
class GreedyMatcher {
 public:
  GreedyMatcher(std::span<const Timestamp> gt, std::span<const Timestamp> est,
                const AssociationOptions& options)
      : gt_(gt), est_(est), options_(options) {
    merge();
    for (std::size_t i = 0; i + 1 < events_.size(); ++i) add_candidate(i, i + 1);
  }

  [[nodiscard]] std::vector<IndexPair> run() {
    std::vector<IndexPair> pairs;
    while (!heap_.empty()) {
      const Candidate best = heap_.top();
      heap_.pop();
      if (events_[best.left].matched || events_[best.right].matched) continue;
      pairs.push_back(pair_of(best.left, best.right));
      remove(best);
    }
    std::sort(pairs.begin(), pairs.end(),
              [](const IndexPair& a, const IndexPair& b) { return a.est < b.est; });
    return pairs;
  }

 private:
  [[nodiscard]] double difference(std::size_t gt, std::size_t est) const {
    return std::abs(stamp_difference(gt_[gt], est_[est], options_.offset_s, options_.arithmetic));
  }

  void merge() {
    events_.reserve(gt_.size() + est_.size());
    std::size_t g = 0;
    std::size_t e = 0;
    while (g < gt_.size() || e < est_.size()) {
      const bool gt_first =
          e == est_.size() || (g < gt_.size() && gt_[g] <= after(est_[e], options_.offset_s));
      const std::size_t index = events_.size();
      events_.push_back({gt_first ? g++ : e++, gt_first, index == 0 ? kNone : index - 1, index + 1});
    }
    if (!events_.empty()) events_.back().next = kNone;
  }

  [[nodiscard]] IndexPair pair_of(std::size_t left, std::size_t right) const {
    return events_[left].is_gt ? IndexPair{events_[left].index, events_[right].index}
                               : IndexPair{events_[right].index, events_[left].index};
  }

  void add_candidate(std::size_t left, std::size_t right) {
    if (events_[left].is_gt == events_[right].is_gt) return;
    const IndexPair pair = pair_of(left, right);
    const double difference_s = difference(pair.gt, pair.est);
    if (difference_s < options_.max_difference_s) heap_.push({difference_s, left, right});
  }

  void remove(const Candidate& pair) {
    events_[pair.left].matched = events_[pair.right].matched = true;
    const std::size_t previous = events_[pair.left].previous;
    const std::size_t next = events_[pair.right].next;
    if (previous != kNone) events_[previous].next = next;
    if (next != kNone) events_[next].previous = previous;
    if (previous != kNone && next != kNone) add_candidate(previous, next);
  }

  /// Heap order: the smallest difference is on top; among equal ones the earliest pair.
  struct LowerPriority {
    bool operator()(const Candidate& a, const Candidate& b) const {
      if (a.difference_s != b.difference_s) return a.difference_s > b.difference_s;
      return a.left > b.left;
    }
  };

  std::span<const Timestamp> gt_;
  std::span<const Timestamp> est_;
  const AssociationOptions& options_;
  std::vector<Event> events_;
  std::priority_queue<Candidate, std::vector<Candidate>, LowerPriority> heap_;
};

}  // namespace

std::vector<IndexPair> associate_tum(std::span<const Timestamp> gt, std::span<const Timestamp> est,
                                     const AssociationOptions& options) {
  return GreedyMatcher(gt, est, options).run();
}

std::vector<IndexPair> associate_tum(const Trajectory& gt, const Trajectory& est,
                                     const AssociationOptions& options) {
  return associate_tum(timestamps_of(gt), timestamps_of(est), options);
}

std::vector<IndexPair> associate_evo(const Trajectory& gt, const Trajectory& est,
                                     const AssociationOptions& options) {
  const bool gt_is_longer = gt.poses.size() >= est.poses.size();
  const std::size_t shorter = std::min(gt.poses.size(), est.poses.size());
  const std::size_t longer = std::max(gt.poses.size(), est.poses.size());
  const auto pair_of = [&](std::size_t s, std::size_t l) {
    return gt_is_longer ? IndexPair{l, s} : IndexPair{s, l};
  };
  const auto difference = [&](const IndexPair& pair) {
    return std::abs(
        stamp_difference(gt.poses[pair.gt].t, est.poses[pair.est].t, options.offset_s, options.arithmetic));
  };
  std::vector<IndexPair> pairs;
  std::size_t l = 0;
  for (std::size_t s = 0; s < shorter; ++s) {
    while (l + 1 < longer && difference(pair_of(s, l + 1)) < difference(pair_of(s, l))) ++l;
    if (difference(pair_of(s, l)) <= options.max_difference_s) pairs.push_back(pair_of(s, l));
  }
  return pairs;
}

namespace {

/// The last pose at or before t, not before `from`; `from` if there is none. Doubles the step, so that the
/// next pose costs as little as that of an estimate with a millionth of the poses.
std::size_t last_until(const std::vector<StampedPose>& poses, std::size_t from, Timestamp t) {
  std::size_t step = 1;
  while (from + step < poses.size() && poses[from + step].t <= t) step *= 2;
  const auto begin = poses.begin() + static_cast<std::ptrdiff_t>(from + step / 2);
  const auto end = poses.begin() + static_cast<std::ptrdiff_t>(std::min(from + step, poses.size()));
  const auto after_t = std::upper_bound(
      begin, end, t, [](Timestamp value, const StampedPose& pose) { return value < pose.t; });
  return std::max(from, static_cast<std::size_t>(after_t - poses.begin()) -
                            (after_t == poses.begin() ? std::size_t{0} : std::size_t{1}));
}

}  // namespace

std::vector<InterpolatedPair> associate_interpolated(const Trajectory& gt, const Trajectory& est,
                                                     double max_gap_s, double offset_s) {
  std::vector<InterpolatedPair> pairs;
  if (gt.poses.empty()) return pairs;
  std::size_t g = 0;
  for (std::size_t e = 0; e < est.poses.size(); ++e) {
    const Timestamp t = after(est.poses[e].t, offset_s);
    g = last_until(gt.poses, g, t);
    if (t < gt.poses[g].t) continue;
    if (t == gt.poses[g].t) {
      pairs.push_back({g, e, 0.0});
      continue;
    }
    if (g + 1 == gt.poses.size()) break;
    const double to_previous = seconds_between(gt.poses[g].t, t);
    const double to_next = seconds_between(t, gt.poses[g + 1].t);
    if (std::max(to_previous, to_next) < max_gap_s) {
      pairs.push_back({g, e, to_previous / (to_previous + to_next)});
    }
  }
  return pairs;
}

std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                       std::span<const IndexPair> pairs) {
  std::vector<MatchedPose> matches;
  matches.reserve(pairs.size());
  for (const IndexPair& pair : pairs) {
    matches.push_back({est.poses[pair.est].t, gt.poses[pair.gt].T_w_f, est.poses[pair.est].T_w_f});
  }
  return matches;
}

std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                       std::span<const InterpolatedPair> pairs) {
  std::vector<MatchedPose> matches;
  matches.reserve(pairs.size());
  for (const InterpolatedPair& pair : pairs) {
    const Pose& from = gt.poses[pair.gt].T_w_f;
    const Pose interpolated =
        pair.fraction > 0.0 ? interpolate(from, gt.poses[pair.gt + 1].T_w_f, pair.fraction) : from;
    matches.push_back({est.poses[pair.est].t, interpolated, est.poses[pair.est].T_w_f});
  }
  return matches;
}

double stamp_as_double(Timestamp t) {
  // Divides in extended precision, so that rounding to double gives the double closest to the decimal text.
  return static_cast<double>(static_cast<long double>(t.ns) / 1e9L);
}

double stamp_difference(Timestamp a, Timestamp b, double b_offset_s, StampArithmetic arithmetic) {
  if (arithmetic == StampArithmetic::kDouble) {
    return stamp_as_double(a) - (stamp_as_double(b) + b_offset_s);
  }
  return static_cast<double>(a.ns - after(b, b_offset_s).ns) / 1e9;
}

namespace {

std::string span_text(Timestamp first, Timestamp last) {
  return format_stamp(first) + " to " + format_stamp(last) + " s";
}

/// A known cause of stamps that do not overlap, with the offset that corrects it.
std::string likely_cause(double gt_s, double est_s) {
  struct Unit {
    double ratio;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}};
  for (const auto& [ratio, name] : kUnits) {
    if (gt_s > 0.0 && std::abs(est_s / gt_s / ratio - 1.0) < 0.1)
      return std::string("the stamps of the estimate seem to be in ") + name + " instead of seconds";
    if (est_s > 0.0 && std::abs(gt_s / est_s / ratio - 1.0) < 0.1)
      return std::string("the stamps of the ground truth seem to be in ") + name + " instead of seconds";
  }
  constexpr double kGpsEpoch = 315964800.0;  // 1980-01-06 in Unix time [s]
  constexpr double kMinUnixTime = 1e8;
  const double difference_s = gt_s - est_s;
  char text[160];
  if (std::abs(std::abs(difference_s) - kGpsEpoch) < 86400.0) {
    std::snprintf(text, sizeof text,
                  "one seems to count from the GPS epoch: try --offset %.0f, less leap seconds",
                  difference_s > 0.0 ? kGpsEpoch : -kGpsEpoch);
    return text;
  }
  if ((std::abs(gt_s) > kMinUnixTime) != (std::abs(est_s) > kMinUnixTime)) {
    std::snprintf(text, sizeof text,
                  "one seems to count from its start, the other from 1970: try --offset %.3f", difference_s);
    return text;
  }
  const double hours = std::round(difference_s / 3600.0);
  if (hours != 0.0 && std::abs(hours) <= 14.0 && std::abs(difference_s - 3600.0 * hours) < 300.0) {
    std::snprintf(text, sizeof text, "one seems to be in local time: try --offset %.0f", 3600.0 * hours);
    return text;
  }
  return "are both of the same recording, and their stamps of the same clock (--offset)?";
}

}  // namespace

void require_overlap(const Trajectory& gt, const Trajectory& est, double offset_s, const std::string& place) {
  const Timestamp gt_first = gt.poses.front().t;
  const Timestamp gt_last = gt.poses.back().t;
  const Timestamp est_first = after(est.poses.front().t, offset_s);
  const Timestamp est_last = after(est.poses.back().t, offset_s);
  if (est_first <= gt_last && gt_first <= est_last) return;
  throw InputError(place, "covers " + span_text(est_first, est_last) + ", the ground truth " +
                              span_text(gt_first, gt_last) + ": no overlap in time; " +
                              likely_cause(to_seconds(gt_first), to_seconds(est_first)));
}

}  // namespace stillpoint::eval
