// SPDX-License-Identifier: BSD-3-Clause
/// Claims of systems against true poses in Python: NEES, honesty, loops; and the statistics of lists of
/// numbers.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/python/arrays.h"
#include "bench/python/eval_bindings.h"
#include "bench/python/records.h"
#include "eval/metrics/consistency.h"
#include "eval/metrics/loop_metrics.h"
#include "eval/statistics/change_points.h"
#include "eval/statistics/modes.h"
#include "eval/statistics/rank_tests.h"

namespace stillpoint::python {
namespace {

using eval::ClaimedPose;
using eval::PoseClaim;

constexpr const char* kClaims[] = {"none", "located", "dead_reckoning", "lost"};  // in the order of PoseClaim

PoseClaim claim_of(const std::string& name) {
  for (std::size_t i = 0; i < std::size(kClaims); ++i)
    if (name == kClaims[i]) return static_cast<PoseClaim>(i);
  throw InputError("claims",
                   "unknown value \"" + name + "\"; expected one of: none, located, dead_reckoning, lost");
}

/// Row i of [n, 3, 3].
Eigen::Matrix3d covariance_at(const Doubles& covariances, std::size_t i) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(covariances.data() + 9 * i);
}

std::vector<ClaimedPose> located_claims(const Trajectory& est, const Doubles& position,
                                        const Doubles& rotation) {
  const auto count = static_cast<py::ssize_t>(est.poses.size());
  require_shape(position, "position_covariance", {count, 3, 3});
  require_shape(rotation, "rotation_covariance", {count, 3, 3});
  std::vector<ClaimedPose> claims;
  claims.reserve(est.poses.size());
  for (std::size_t i = 0; i < est.poses.size(); ++i) {
    claims.push_back({.t = est.poses[i].t,
                      .T_w_c = est.poses[i].T_w_f,
                      .claim = PoseClaim::kLocated,
                      .position_covariance = covariance_at(position, i),
                      .rotation_covariance = covariance_at(rotation, i)});
  }
  return claims;
}

eval::ClaimOrigin origin_of(const std::string& name) {
  if (name == "first_pose") return eval::ClaimOrigin::kFirstPose;
  if (name == "world") return eval::ClaimOrigin::kWorld;
  throw InputError("origin", "unknown value \"" + name + "\"; expected one of: first_pose, world");
}

/// NEES of each pose, in the same world: rotation and position.
py::tuple nees_of(const Trajectory& gt, const Trajectory& est, const Doubles& rotation,
                  const Doubles& position) {
  if (gt.poses.size() != est.poses.size()) {
    throw InputError("est", "has " + std::to_string(est.poses.size()) + " poses and gt " +
                                std::to_string(gt.poses.size()) + "; match them first");
  }
  const std::vector<ClaimedPose> claims = located_claims(est, position, rotation);
  std::vector<double> rotations;
  std::vector<double> positions;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    const eval::Nees nees = eval::nees(gt.poses[i].T_w_f, claims[i].T_w_c, claims[i].rotation_covariance,
                                       claims[i].position_covariance);
    rotations.push_back(nees.rotation);
    positions.push_back(nees.position);
  }
  return py::make_tuple(array_of(std::move(rotations)), array_of(std::move(positions)));
}

void bind_nees(py::module_& m) {
  using eval::ClaimQuality;
  Record<ClaimQuality>(m, "ClaimQuality", "Errors of position or rotation against their claimed covariances.")
      .field("nees", &ClaimQuality::nees, "Mean of NEES / 3: 1 for a consistent estimator.")
      .field("nees_low", &ClaimQuality::nees_low, "Of the interval that contains it with 95 % if consistent.")
      .field("nees_high", &ClaimQuality::nees_high, "Same.")
      .field("nll", &ClaimQuality::nll, "Mean negative log-likelihood, of errors in m or rad.")
      .field("within_3_sigma", &ClaimQuality::within_3_sigma,
             "Fraction of components; .9973 of a normal error.");
  using eval::CovarianceScore;
  Record<CovarianceScore>(m, "CovarianceScore", "Quality of the covariances of a run.")
      .field("poses", &CovarianceScore::poses, "That count.")
      .field("position", &CovarianceScore::position, "ClaimQuality.")
      .field("rotation", &CovarianceScore::rotation, "ClaimQuality.");
  m.def(
      "covariance_score",
      [](const Trajectory& gt, const Trajectory& est, const Doubles& position, const Doubles& rotation,
         const std::string& origin) {
        const std::vector<ClaimedPose> claims = located_claims(est, position, rotation);
        const eval::ClaimOrigin claim_origin = origin_of(origin);
        const py::gil_scoped_release release;
        return eval::covariance_score(gt, claims, claim_origin);
      },
      py::arg("gt"), py::arg("est"), py::arg("position_covariance"), py::arg("rotation_covariance"),
      py::arg("origin") = "first_pose",
      "NEES, likelihood and coverage of covariances [n, 3, 3] of position, m^2, and rotation about the axes "
      "of the world, "
      "rad^2, that are relative to the first pose (`first_pose`) or to the world; None if no pose counts: "
      "none is 3 s "
      "later than the first, or none has a covariance.");
  m.def("nees", &nees_of, py::arg("gt"), py::arg("est"), py::arg("rotation_covariance"),
        py::arg("position_covariance"),
        "NEES of the rotation [n] and of the position [n] of poses in the same world, pose by pose; both are "
        "3 in the mean "
        "for a consistent estimator. Raises InputError for a covariance that is not positive definite.");
}

/// Arguments of `honesty` per frame.
struct ClaimArrays {
  std::vector<std::string> claims;
  Doubles sigma_m;
  Doubles sigma_rad;
  std::vector<int> segments;
};

std::vector<ClaimedPose> claims_of(const Trajectory& est, const ClaimArrays& arrays) {
  const auto count = static_cast<py::ssize_t>(est.poses.size());
  require_shape(arrays.sigma_m, "sigma_m", {count});
  require_shape(arrays.sigma_rad, "sigma_rad", {count});
  if (arrays.claims.size() != est.poses.size() || arrays.segments.size() != est.poses.size())
    throw InputError("claims", "and segments need one element per pose");
  std::vector<ClaimedPose> claims;
  for (std::size_t i = 0; i < est.poses.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    claims.push_back({.t = est.poses[i].t,
                      .T_w_c = est.poses[i].T_w_f,
                      .claim = claim_of(arrays.claims[i]),
                      .segment = arrays.segments[i],
                      .sigma_m = arrays.sigma_m.at(row),
                      .sigma_rad = arrays.sigma_rad.at(row)});
  }
  return claims;
}

std::vector<eval::TimeSpan> spans_of(const Integers& spans) {
  require_shape(spans, "faults_ns", {-1, 2});
  std::vector<eval::TimeSpan> result;
  for (py::ssize_t i = 0; i < spans.shape(0); ++i)
    result.push_back({Timestamp{spans.at(i, 0)}, Timestamp{spans.at(i, 1)}});
  return result;
}

void bind_honesty(py::module_& m) {
  using eval::Honesty;
  Record<Honesty>(m, "Honesty", "Whether a system knows when its pose is wrong.")
      .field("false_confidence", &Honesty::false_confidence,
             "Fraction of all frames that are located and wrong.")
      .field("missed_availability", &Honesty::missed_availability,
             "Fraction of frames that are lost without need.")
      .field("time_to_detect_s", &Honesty::time_to_detect_s, "s; None if no pose was wrong.")
      .field("time_to_recover_s", &Honesty::time_to_recover_s, "s; None without a recovery.")
      .field("error_after_recovery_m", &Honesty::error_after_recovery_m, "m; None without a recovery.");
  m.def(
      "honesty",
      [](const Trajectory& gt, const Trajectory& est, const std::vector<std::string>& claims,
         const Doubles& sigma_m, const Doubles& sigma_rad, const std::vector<int>& segments,
         const Integers& faults_ns) {
        return eval::honesty(gt, claims_of(est, {claims, sigma_m, sigma_rad, segments}), spans_of(faults_ns));
      },
      py::arg("gt"), py::arg("est"), py::arg("claims"), py::arg("sigma_m"), py::arg("sigma_rad"),
      py::arg("segments"), py::arg("faults_ns"),
      "Of one pose per frame, with its claim (none, located, dead_reckoning or lost), standard deviations "
      "[n], m and rad, "
      "and segment, and intervals of faults [k, 2], ns; None if fewer than ten located frames have a true "
      "pose.");
}

eval::ReportedLoop loop_of(const std::tuple<std::int64_t, std::int64_t, Doubles, bool>& loop) {
  return {.query_t = Timestamp{std::get<0>(loop)},
          .match_t = Timestamp{std::get<1>(loop)},
          .T_match_query = rigid_of(std::get<2>(loop), "loops: T_match_query"),
          .accepted = std::get<3>(loop)};
}

void bind_loops(py::module_& m) {
  using eval::RevisitScore;
  Record<RevisitScore>(m, "RevisitScore", "Precision and recall of loops.")
      .field("true_loops", &RevisitScore::true_loops, "Accepted.")
      .field("false_loops", &RevisitScore::false_loops, "Accepted, but off by more than 20 cm or 5 deg.")
      .field("missed_loops", &RevisitScore::missed_loops, "Not accepted although within the limits.")
      .field("revisits", &RevisitScore::revisits, "Keyframes at a place of an earlier keyframe.")
      .field("recognized", &RevisitScore::recognized, "Revisits with an accepted true loop.")
      .field("recall", &RevisitScore::recall, "In [0, 1]; None without revisits.");
  m.def(
      "score_revisits",
      [](const Trajectory& gt, const py::object& keyframes_ns,
         const std::vector<std::tuple<std::int64_t, std::int64_t, Doubles, bool>>& loops) {
        std::vector<eval::ReportedLoop> reported;
        for (const auto& loop : loops) reported.push_back(loop_of(loop));
        return eval::score_revisits(gt, stamps_of(keyframes_ns, "keyframes_ns"), reported);
      },
      py::arg("gt"), py::arg("keyframes_ns"), py::arg("loops"),
      "Loops (query_ns, match_ns, T_match_query [4, 4], accepted) against true camera poses; `keyframes_ns`: "
      "int64 [n].");
  using eval::ErrorAfterLoop;
  Record<ErrorAfterLoop>(m, "ErrorAfterLoop", "Errors once loops correct the trajectory.")
      .field("odometry_m", &ErrorAfterLoop::odometry_m, "m.")
      .field("causal_m", &ErrorAfterLoop::causal_m, "m.")
      .field("ratio", &ErrorAfterLoop::ratio, "None if the odometry has no error.");
  m.def(
      "error_after_loop",
      [](const Trajectory& gt, const Trajectory& odometry, const Trajectory& causal,
         std::int64_t first_loop_ns) {
        return eval::error_after_loop(gt, odometry, causal, Timestamp{first_loop_ns});
      },
      py::arg("gt"), py::arg("odometry"), py::arg("causal"), py::arg("first_loop_ns"),
      "Error of the trajectory with the corrections known at each frame, and of the odometry, after the "
      "first loop.");
}

/// @throws InputError for a value that is not finite
std::span<const double> finite_span(const Doubles& values, const char* name) {
  require_shape(values, name, {-1});
  const std::span<const double> span = span_of(values);
  for (const double value : span)
    if (!std::isfinite(value)) throw InputError(name, "has a value that is not finite");
  return span;
}

double checked_confidence(double confidence) {
  if (!(confidence > 0.0 && confidence < 1.0)) throw InputError("confidence", "must be in (0, 1)");
  return confidence;
}

std::vector<eval::Pair> pairs_of(const Doubles& base, const Doubles& changed) {
  const std::span<const double> first = finite_span(base, "base");
  const std::span<const double> second = finite_span(changed, "changed");
  if (first.size() != second.size()) throw InputError("changed", "needs one value for each of base");
  std::vector<eval::Pair> pairs;
  for (std::size_t i = 0; i < first.size(); ++i) pairs.push_back({first[i], second[i]});
  return pairs;
}

template <class Result>
auto interval_field() {
  return [](const Result& result) -> std::optional<std::pair<double, double>> {
    if (!result.interval) return std::nullopt;
    return std::pair(result.interval->low, result.interval->high);
  };
}

void bind_results(py::module_& m) {
  using eval::Spread;
  Record<Spread>(m, "Spread", "Summary of repeated measurements by order statistics.")
      .field("count", &Spread::count, "Number of values.")
      .field("median", &Spread::median, "Median.")
      .field(
          "quartiles", [](const Spread& s) { return std::pair(s.quartiles.low, s.quartiles.high); },
          "(low, high)")
      .field("worst", &Spread::worst, "The largest value, or the smallest if larger is better.")
      .field(
          "median_interval",
          [](const Spread& s) -> std::optional<std::pair<double, double>> {
            if (!s.median_interval) return std::nullopt;
            return std::pair(s.median_interval->low, s.median_interval->high);
          },
          "(low, high); None if there are too few values.")
      .field("modes", &Spread::modes, "Number of modes; None if unknown.");
  using eval::RankSum;
  Record<RankSum>(m, "RankSum", "Result of the two-sample rank test.")
      .field("shift", &RankSum::shift, "From the first sample to the second.")
      .field("p_value", &RankSum::p_value, "Two-sided.")
      .field("interval", interval_field<RankSum>(),
             "(low, high) of the shift; None if there are too few values.");
  using eval::SignedRank;
  Record<SignedRank>(m, "SignedRank", "Result of the signed-rank test.")
      .field("count", &SignedRank::count, "Number of differences.")
      .field("estimate", &SignedRank::estimate, "Pseudomedian.")
      .field("p_value", &SignedRank::p_value, "Two-sided.")
      .field("interval", interval_field<SignedRank>(), "(low, high); None if there are too few values.");
  using eval::PairedDifference;
  Record<PairedDifference>(m, "PairedDifference", "changed - base, in the unit of the values.")
      .field("count", &PairedDifference::count, "Number of pairs.")
      .field("median", &PairedDifference::median, "Pseudomedian.")
      .field("p_value", &PairedDifference::p_value, "Two-sided.")
      .field("interval", interval_field<PairedDifference>(), "(low, high); None if there are too few pairs.")
      .field("effect", &PairedDifference::effect, "Rank-biserial correlation, in [-1, 1].");
  using eval::RelativeChange;
  Record<RelativeChange>(m, "RelativeChange", "changed / base - 1.")
      .field("count", &RelativeChange::count, "Number of values.")
      .field("median", &RelativeChange::median, "Pseudomedian.")
      .field("p_value", &RelativeChange::p_value, "Two-sided.")
      .field("interval", interval_field<RelativeChange>(), "(low, high); None if there are too few values.");
}

void bind_rank_tests(py::module_& m) {
  const py::arg_v confidence = py::arg("confidence") = 0.95;
  m.def(
      "spread",
      [](const Doubles& values, double level) {
        return eval::spread(finite_span(values, "values"), checked_confidence(level));
      },
      py::arg("values"), confidence, "Median, quartiles and interval; None for an empty list.");
  m.def(
      "rank_sum",
      [](const Doubles& before, const Doubles& after, double level) {
        return eval::rank_sum(finite_span(before, "before"), finite_span(after, "after"),
                              checked_confidence(level));
      },
      py::arg("before"), py::arg("after"), confidence,
      "Exact test of Mann and Whitney; None if a side is empty.");
  m.def(
      "signed_rank",
      [](const Doubles& differences, double level) {
        return eval::signed_rank(finite_span(differences, "differences"), checked_confidence(level));
      },
      py::arg("differences"), confidence, "Exact test of Wilcoxon; None for an empty list.");
  m.def(
      "paired_difference",
      [](const Doubles& base, const Doubles& changed, double level) {
        return eval::paired_difference(pairs_of(base, changed), checked_confidence(level));
      },
      py::arg("base"), py::arg("changed"), confidence,
      "Of values of the same conditions; None without pairs.");
  m.def(
      "relative_change",
      [](const Doubles& base, const Doubles& changed, double level) {
        return eval::relative_change(pairs_of(base, changed), checked_confidence(level));
      },
      py::arg("base"), py::arg("changed"), confidence,
      "Of values of the same conditions; None without usable pairs.");
}

void bind_series(py::module_& m) {
  m.def(
      "mode_count", [](const Doubles& values) { return eval::mode_count(finite_span(values, "values")); },
      py::arg("values"), "Number of modes of positive values; None for fewer than five.");
  m.def(
      "change_points",
      [](const Doubles& values, std::size_t min_segment, double significance) {
        if (min_segment < 2) throw InputError("min_segment", "must be 2 or more");
        std::vector<std::pair<std::size_t, double>> points;
        for (const eval::ChangePoint& point : eval::change_points(
                 finite_span(values, "values"), {.min_segment = min_segment, .significance = significance}))
          points.emplace_back(point.index, point.p_value);
        return points;
      },
      py::arg("values"), py::arg("min_segment") = 3, py::arg("significance") = 0.005,
      "(index of the first value after the change, p-value) of each significant change of a series "
      "(E-divisive).");
}

}  // namespace

void bind_consistency(py::module_& module) {
  bind_nees(module);
  bind_honesty(module);
  bind_loops(module);
}

void bind_statistics(py::module_& module) {
  bind_results(module);
  bind_rank_tests(module);
  bind_series(module);
}

}  // namespace stillpoint::python
