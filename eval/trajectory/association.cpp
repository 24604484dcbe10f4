// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/association.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <queue>
#include <utility>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

constexpr PoseIndex kNone = static_cast<PoseIndex>(-1);

/// A stamp of either list on the common time axis. Unmatched ones form a doubly linked list.
struct Event {
  PoseIndex index;
  PoseIndex previous;
  PoseIndex next;
};

/// Neighbors on the time axis, one of each list.
struct Candidate {
  double difference_s;
  PoseIndex left;  ///< event indices
  PoseIndex right;

  /// Order of matching: the smallest difference first; among equal ones the earliest pair.
  [[nodiscard]] bool precedes(const Candidate& other) const {
    if (difference_s != other.difference_s) return difference_s < other.difference_s;
    return left < other.left;
  }
};

/// Greedy matching by time difference. The closest unmatched pair always consists of neighbors on the time
/// axis, because anything between them would be closer to one of the two. The sorted pairs of neighbors and a
/// heap of those that become neighbors therefore suffice, and removing a pair creates at most one new pair of
/// neighbors.
/// @tparam Stamps a list of stamps with `size()` and `operator[]`
template <class Stamps>
class GreedyMatcher {
 public:
  GreedyMatcher(const Stamps& gt, const Stamps& est, const AssociationOptions& options)
      : gt_(gt), est_(est), options_(options) {
    merge();
    candidates_.reserve(events_.empty() ? 0 : events_.size() - 1);
    for (PoseIndex i = 0; i + 1 < events_.size(); ++i) {
      if (const std::optional<Candidate> found = candidate(i, i + 1)) candidates_.push_back(*found);
    }
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return a.precedes(b); });
  }

  [[nodiscard]] std::vector<IndexPair> run() {
    std::vector<IndexPair> pairs;
    pairs.reserve(std::min(gt_.size(), est_.size()));
    while (const std::optional<Candidate> best = take_best()) {
      if (is_matched_[best->left] || is_matched_[best->right]) continue;
      pairs.push_back(pair_of(best->left, best->right));
      remove(*best);
    }
    std::sort(pairs.begin(), pairs.end(),
              [](const IndexPair& a, const IndexPair& b) { return a.est < b.est; });
    return pairs;
  }

 private:
  [[nodiscard]] double difference(PoseIndex gt, PoseIndex est) const {
    return std::abs(stamp_difference(gt_[gt], est_[est], options_.offset_s, options_.arithmetic));
  }

  void merge() {
    const std::size_t count = gt_.size() + est_.size();
    STILLPOINT_CHECK(count < kNone);
    events_.reserve(count);
    is_gt_.reserve(count);
    is_matched_.assign(count, false);
    PoseIndex g = 0;
    PoseIndex e = 0;
    while (g < gt_.size() || e < est_.size()) {
      const bool gt_first =
          e == est_.size() || (g < gt_.size() && gt_[g] <= after(est_[e], options_.offset_s));
      const auto index = static_cast<PoseIndex>(events_.size());
      events_.push_back({gt_first ? g++ : e++, index == 0 ? kNone : index - 1, index + 1});
      is_gt_.push_back(gt_first);
    }
    if (!events_.empty()) events_.back().next = kNone;
  }

  [[nodiscard]] IndexPair pair_of(PoseIndex left, PoseIndex right) const {
    return is_gt_[left] ? IndexPair{events_[left].index, events_[right].index}
                        : IndexPair{events_[right].index, events_[left].index};
  }

  [[nodiscard]] std::optional<Candidate> candidate(PoseIndex left, PoseIndex right) const {
    if (is_gt_[left] == is_gt_[right]) return std::nullopt;
    const IndexPair pair = pair_of(left, right);
    const double difference_s = difference(pair.gt, pair.est);
    if (!(difference_s < options_.max_difference_s)) return std::nullopt;
    return Candidate{difference_s, left, right};
  }

  /// The first candidate in the order of matching; nullopt if none is left.
  [[nodiscard]] std::optional<Candidate> take_best() {
    const bool has_candidate = next_candidate_ < candidates_.size();
    if (!has_candidate && heap_.empty()) return std::nullopt;
    if (heap_.empty() || (has_candidate && !heap_.top().precedes(candidates_[next_candidate_])))
      return candidates_[next_candidate_++];
    const Candidate best = heap_.top();
    heap_.pop();
    return best;
  }

  void remove(const Candidate& pair) {
    is_matched_[pair.left] = is_matched_[pair.right] = true;
    const PoseIndex previous = events_[pair.left].previous;
    const PoseIndex next = events_[pair.right].next;
    if (previous != kNone) events_[previous].next = next;
    if (next != kNone) events_[next].previous = previous;
    if (previous == kNone || next == kNone) return;
    if (const std::optional<Candidate> found = candidate(previous, next)) heap_.push(*found);
  }

  struct LowerPriority {
    bool operator()(const Candidate& a, const Candidate& b) const { return b.precedes(a); }
  };

  const Stamps& gt_;
  const Stamps& est_;
  const AssociationOptions& options_;
  std::vector<Event> events_;
  std::vector<bool> is_gt_;  ///< of each event
  std::vector<bool> is_matched_;
  std::vector<Candidate> candidates_;  ///< neighbors at the start, in the order of matching
  std::size_t next_candidate_ = 0;
  std::priority_queue<Candidate, std::vector<Candidate>, LowerPriority> heap_;  ///< later neighbors
};

/// The stamps of a trajectory as a list.
struct TrajectoryStamps {
  const std::vector<StampedPose>& poses;

  [[nodiscard]] std::size_t size() const { return poses.size(); }
  [[nodiscard]] bool empty() const { return poses.empty(); }
  [[nodiscard]] Timestamp operator[](std::size_t i) const { return poses[i].t; }
};

/// Stamps of a list that are not matched yet.
template <class Stamps>
struct RemainingStamps {
  const Stamps& all;
  std::vector<PoseIndex> indices;

  [[nodiscard]] std::size_t size() const { return indices.size(); }
  [[nodiscard]] Timestamp operator[](std::size_t i) const { return all[indices[i]]; }
};

/// Pairs of which each stamp is closer to the other than to any other one. Greedy matching contains them,
/// since nothing takes one of the two before, and matches the remaining stamps as without them. They are
/// nearly all pairs of most recordings, and are found without sorting.
template <class Stamps>
class MutualPairs {
 public:
  MutualPairs(const Stamps& gt, const Stamps& est, const AssociationOptions& options)
      : gt_(gt),
        est_(est),
        max_difference_ns_(1e9 * options.max_difference_s),
        offset_ns_(1e9 * options.offset_s) {}

  [[nodiscard]] std::vector<IndexPair> find() const {
    std::vector<IndexPair> pairs;
    pairs.reserve(std::min(gt_.size(), est_.size()));
    std::size_t g = 0;
    for (std::size_t e = 0; e < est_.size() && !gt_.empty(); ++e) {
      const double t = estimated(e);
      while (g + 1 < gt_.size() && distance(g + 1, t) <= distance(g, t)) ++g;
      if (is_mutual(g, e)) pairs.push_back({static_cast<PoseIndex>(g), static_cast<PoseIndex>(e)});
    }
    return pairs;
  }

 private:
  // [ns]; more than the rounding of differences of stamps in double precision, so that equal ones are
  // left to the order of matching
  static constexpr double kMargin = 1e4;

  [[nodiscard]] double estimated(std::size_t e) const { return static_cast<double>(est_[e].ns) + offset_ns_; }
  [[nodiscard]] double distance(std::size_t g, double t) const {
    return std::abs(static_cast<double>(gt_[g].ns) - t);
  }

  [[nodiscard]] bool is_mutual(std::size_t g, std::size_t e) const {
    const double t = estimated(e);
    const double limit = distance(g, t) + kMargin;
    return limit < max_difference_ns_ && (g == 0 || limit < distance(g - 1, t)) &&
           (g + 1 == gt_.size() || limit < distance(g + 1, t)) &&
           (e == 0 || limit < distance(g, estimated(e - 1))) &&
           (e + 1 == est_.size() || limit < distance(g, estimated(e + 1)));
  }

  const Stamps& gt_;
  const Stamps& est_;
  double max_difference_ns_;
  double offset_ns_;
};

/// The indices below `count` that `member` of no pair has.
std::vector<PoseIndex> unmatched(std::size_t count, const std::vector<IndexPair>& pairs,
                                 PoseIndex IndexPair::*member) {
  std::vector<PoseIndex> indices;
  auto pair = pairs.begin();
  for (PoseIndex i = 0; i < count; ++i) {
    if (pair != pairs.end() && (*pair).*member == i) {
      ++pair;
    } else {
      indices.push_back(i);
    }
  }
  return indices;
}

template <class Stamps>
std::vector<IndexPair> associate_greedily(const Stamps& gt, const Stamps& est,
                                          const AssociationOptions& options) {
  std::vector<IndexPair> pairs = MutualPairs(gt, est, options).find();
  const RemainingStamps<Stamps> gt_rest{gt, unmatched(gt.size(), pairs, &IndexPair::gt)};
  const RemainingStamps<Stamps> est_rest{est, unmatched(est.size(), pairs, &IndexPair::est)};
  const auto mutual = static_cast<std::ptrdiff_t>(pairs.size());
  for (const IndexPair& pair : GreedyMatcher(gt_rest, est_rest, options).run())
    pairs.push_back({gt_rest.indices[pair.gt], est_rest.indices[pair.est]});
  std::inplace_merge(pairs.begin(), pairs.begin() + mutual, pairs.end(),
                     [](const IndexPair& a, const IndexPair& b) { return a.est < b.est; });
  return pairs;
}

}  // namespace

std::vector<IndexPair> associate_tum(std::span<const Timestamp> gt, std::span<const Timestamp> est,
                                     const AssociationOptions& options) {
  return associate_greedily(gt, est, options);
}

std::vector<IndexPair> associate_tum(const Trajectory& gt, const Trajectory& est,
                                     const AssociationOptions& options) {
  return associate_greedily(TrajectoryStamps{gt.poses}, TrajectoryStamps{est.poses}, options);
}

std::vector<IndexPair> associate_evo(const Trajectory& gt, const Trajectory& est,
                                     const AssociationOptions& options) {
  const bool gt_is_longer = gt.poses.size() >= est.poses.size();
  const auto shorter = static_cast<PoseIndex>(std::min(gt.poses.size(), est.poses.size()));
  const auto longer = static_cast<PoseIndex>(std::max(gt.poses.size(), est.poses.size()));
  const auto pair_of = [&](PoseIndex s, PoseIndex l) {
    return gt_is_longer ? IndexPair{l, s} : IndexPair{s, l};
  };
  const auto difference = [&](const IndexPair& pair) {
    return std::abs(
        stamp_difference(gt.poses[pair.gt].t, est.poses[pair.est].t, options.offset_s, options.arithmetic));
  };
  std::vector<IndexPair> pairs;
  pairs.reserve(shorter);
  PoseIndex l = 0;
  for (PoseIndex s = 0; s < shorter; ++s) {
    while (l + 1 < longer && difference(pair_of(s, l + 1)) < difference(pair_of(s, l))) ++l;
    if (difference(pair_of(s, l)) <= options.max_difference_s) pairs.push_back(pair_of(s, l));
  }
  return pairs;
}

namespace {

/// The last pose at or before t, not before `from`; `from` if there is none. Searches around a guess with
/// doubled steps, so that the next pose costs as little as that of an estimate with a millionth of the poses.
/// @param guess >= from
std::size_t last_until(const std::vector<StampedPose>& poses, std::size_t from, Timestamp t,
                       std::size_t guess) {
  const auto is_until = [&](std::size_t i) { return i < poses.size() && poses[i].t <= t; };
  std::size_t low = from;
  std::size_t high = guess;  // behind the last one
  std::size_t step = 1;
  if (is_until(guess)) {
    for (low = guess; is_until(low + step); step *= 2) low += step;
    high = low + step;
  } else {
    for (; high > from + step && !is_until(high - step); step *= 2) high -= step;
    low = high > from + step ? high - step : from;
  }
  while (low + 1 < high) {
    const std::size_t middle = low + (high - low) / 2;
    (is_until(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

std::vector<InterpolatedPair> associate_interpolated(const Trajectory& gt, const Trajectory& est,
                                                     double max_gap_s, double offset_s) {
  std::vector<InterpolatedPair> pairs;
  if (gt.poses.empty()) return pairs;
  pairs.reserve(est.poses.size());
  std::size_t g = 0;
  std::size_t step = 0;
  for (std::size_t e = 0; e < est.poses.size(); ++e) {
    const Timestamp t = after(est.poses[e].t, offset_s);
    const std::size_t next = last_until(gt.poses, g, t, g + step);
    step = next - std::exchange(g, next);
    if (t < gt.poses[g].t) continue;
    if (t == gt.poses[g].t) {
      pairs.push_back({static_cast<PoseIndex>(g), static_cast<PoseIndex>(e), 0.0});
      continue;
    }
    if (g + 1 == gt.poses.size()) break;
    const double to_previous = seconds_between(gt.poses[g].t, t);
    const double to_next = seconds_between(t, gt.poses[g + 1].t);
    if (std::max(to_previous, to_next) < max_gap_s) {
      pairs.push_back(
          {static_cast<PoseIndex>(g), static_cast<PoseIndex>(e), to_previous / (to_previous + to_next)});
    }
  }
  return pairs;
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
