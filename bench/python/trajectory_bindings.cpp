// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories in Python: from files and arrays, association by time, alignment.
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/python/arrays.h"
#include "bench/python/eval_bindings.h"
#include "bench/python/records.h"
#include "eval/io/covariance_file.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"
#include "eval/trajectory/alignment.h"
#include "eval/trajectory/association.h"
#include "eval/trajectory/orientations.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::python {
namespace {

using eval::PoseMatches;
using eval::Similarity;

constexpr double kMaxNormError = 0.1;  // as of files
// Of the squared norm of a normalized quaternion, which is used as it is: as 1e-15 of the norm.
constexpr double kRoundingOfNorm = 2e-15;
constexpr double kMaxStamp_s = 9.2e9;  // what int64 nanoseconds represent
constexpr const char* kTimes = "times_ns";

/// Columns of poses, before they are checked.
struct PoseArrays {
  std::vector<Timestamp> stamps;
  Doubles positions;
  Doubles quaternions_xyzw;
};

[[noreturn]] void reject_row(const char* argument, std::size_t row, const std::string& problem) {
  throw InputError(std::string(argument) + "[" + std::to_string(row) + "]", problem);
}

/// A row of the arrays.
struct PoseRow {
  Timestamp t;
  const double* p = nullptr;
  const double* q_xyzw = nullptr;
};

/// @param i of the row, for messages
StampedPose pose_of(const PoseRow& row, std::size_t i) {
  const Eigen::Vector3d position = Eigen::Vector3d::Map(row.p);
  const Eigen::Quaterniond rotation(row.q_xyzw);
  if (!position.allFinite()) reject_row("positions", i, "is not finite; leave out what is no pose");
  const double squared_norm = rotation.squaredNorm();
  if (std::abs(squared_norm - 1.0) <= kRoundingOfNorm) return {row.t, Pose{rotation, position}};
  const double norm = std::sqrt(squared_norm);
  if (!(std::abs(norm - 1.0) <= kMaxNormError)) {
    reject_row("quaternions_xyzw", i,
               "has norm " + std::to_string(norm) + ", expected 1; the order is x, y, z, w");
  }
  return {row.t, Pose{Eigen::Quaterniond(rotation.coeffs() / norm), position}};
}

Trajectory trajectory_of(const PoseArrays& arrays, const std::string& frame) {
  const auto count = static_cast<py::ssize_t>(arrays.stamps.size());
  require_shape(arrays.positions, "positions", {count, 3});
  require_shape(arrays.quaternions_xyzw, "quaternions_xyzw", {count, 4});
  const py::gil_scoped_release release;
  Trajectory trajectory{.frame = frame};
  trajectory.poses.reserve(arrays.stamps.size());
  const double* const p = arrays.positions.data();
  const double* const q = arrays.quaternions_xyzw.data();
  for (std::size_t i = 0; i < arrays.stamps.size(); ++i) {
    if (i > 0 && arrays.stamps[i] <= arrays.stamps[i - 1])
      reject_row(kTimes, i, "is not later than the one before; sort the poses by time");
    trajectory.poses.push_back(pose_of({arrays.stamps[i], p + 3 * i, q + 4 * i}, i));
  }
  return trajectory;
}

std::vector<Timestamp> stamps_of_seconds(const Doubles& times_s) {
  require_shape(times_s, "times_s", {-1});
  std::vector<Timestamp> stamps;
  for (const double t : span_of(times_s)) {
    if (!(std::abs(t) <= kMaxStamp_s))
      reject_row("times_s", stamps.size(), "is no time in seconds; stamps in ns are the argument times_ns");
    stamps.push_back(from_seconds(t));
  }
  return stamps;
}

const double* first_position(const Trajectory& trajectory) {
  return trajectory.poses.empty() ? nullptr : trajectory.poses.front().T_w_f.p.data();
}
const double* first_quaternion(const Trajectory& trajectory) {
  return trajectory.poses.empty() ? nullptr : trajectory.poses.front().T_w_f.q.coeffs().data();
}
const std::int64_t* first_stamp(const Trajectory& trajectory) {
  return trajectory.poses.empty() ? nullptr : &trajectory.poses.front().t.ns;
}

/// One column of a trajectory, without a copy.
template <auto First, int width>
py::array pose_column(const py::object& self) {
  const auto& trajectory = self.cast<const Trajectory&>();
  return column(std::span<const StampedPose>(trajectory.poses), First(trajectory), width, self);
}

py::array matrices_of(const Trajectory& trajectory) {
  std::vector<double> values;
  values.reserve(16 * trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) {
    const Eigen::Matrix4d T = pose.T_w_f.matrix();
    for (int i = 0; i < 16; ++i) values.push_back(T(i / 4, i % 4));
  }
  return array_of(std::move(values)).reshape({-1, 4, 4});
}

void bind_trajectory(py::module_& m) {
  py::class_<Trajectory>(
      m, "Trajectory",
      "Poses T_w_f of a body frame f in a world w, in strictly increasing order of time. The arrays "
      "are read-only views of its memory.")
      .def(py::init([](const py::object& times_ns, const Doubles& positions, const Doubles& quaternions,
                       const std::string& frame) {
             return trajectory_of({stamps_of(times_ns, kTimes), positions, quaternions}, frame);
           }),
           py::arg("times_ns"), py::arg("positions"), py::arg("quaternions_xyzw"), py::arg("frame") = "",
           "From arrays: times int64 or datetime64 [n] in ns, positions [n, 3] in m, quaternions (x, y, z, "
           "w) [n, 4], "
           "whose norms are "
           "within 0.1 of 1. They are copied. Raises InputError for another shape, an order of time that is "
           "not strict, "
           "or a value that is not finite.")
      .def_static(
          "from_seconds",
          [](const Doubles& times_s, const Doubles& positions, const Doubles& quaternions,
             const std::string& frame) {
            return trajectory_of({stamps_of_seconds(times_s), positions, quaternions}, frame);
          },
          py::arg("times_s"), py::arg("positions"), py::arg("quaternions_xyzw"), py::arg("frame") = "",
          "The same with times [s], which are rounded to the nearest nanosecond.")
      .def("__len__", [](const Trajectory& trajectory) { return trajectory.poses.size(); })
      .def("__repr__",
           [](const Trajectory& trajectory) {
             return "Trajectory(" + std::to_string(trajectory.poses.size()) + " poses, frame=\"" +
                    trajectory.frame + "\")";
           })
      .def_property_readonly(
          "frame", [](const Trajectory& trajectory) { return trajectory.frame; }, "Name of the body frame.")
      .def_property_readonly("times_ns", &pose_column<first_stamp, 1>, "Stamps, int64 [n], ns.")
      .def_property_readonly("positions", &pose_column<first_position, 3>, "Positions, [n, 3], m.")
      .def_property_readonly("quaternions_xyzw", &pose_column<first_quaternion, 4>,
                             "Rotations (x, y, z, w), [n, 4].")
      .def("matrices", &matrices_of, "The poses as matrices T_w_f, [n, 4, 4], which are a copy.");
}

void bind_files(py::module_& m) {
  Record<eval::LoadedTrajectory>(m, "LoadedTrajectory", "Contents of a trajectory file.")
      .field("trajectory", &eval::LoadedTrajectory::trajectory, "The poses.")
      .field(
          "repairs", [](const eval::LoadedTrajectory& loaded) { return eval::repair_texts(loaded.repairs); },
          "One sentence for each kind of rows that were skipped or sorted.")
      .field(
          "order_is_assumed",
          [](const eval::LoadedTrajectory& loaded) {
            return loaded.order_source == eval::OrderSource::kAssumed;
          },
          "Whether nothing in the file tells the order of the quaternions.");
  m.def(
      "load_trajectory",
      [](const std::filesystem::path& path, const std::optional<std::string>& format,
         const std::filesystem::path& times, int sequence) {
        eval::TrajectorySource source{.path = path, .times = times, .sequence = sequence};
        if (format) source.format = value_of<eval::TrajectoryFormat>("format", *format);
        const py::gil_scoped_release release;
        return eval::read_trajectory(source);
      },
      py::arg("path"), py::arg("format") = py::none(), py::arg("times") = "", py::arg("sequence") = 0,
      "Reads a file of the formats tum, euroc, kitti (with the file `times`), openloris (`sequence`), "
      "7scenes (a folder) or "
      "nmea; the format is detected unless it is given. Raises InputError for malformed input.");
  m.def(
      "parse_tum",
      [](const std::string& text, const std::string& name) { return eval::parse_tum(text, name).trajectory; },
      py::arg("text"), py::arg("name") = "text", "The poses of a text with rows t tx ty tz qx qy qz qw.");
  m.def("format_tum", &eval::format_tum, py::arg("trajectory"),
        "Text with rows t tx ty tz qx qy qz qw, with 9 decimals.", py::call_guard<py::gil_scoped_release>());
  m.def("write_tum", &eval::write_tum, py::arg("trajectory"), py::arg("file"),
        "Writes `format_tum`; a file of this name is replaced.", py::call_guard<py::gil_scoped_release>());
}

/// Matrices of covariances, [n, 3, 3].
template <auto Member>
py::array covariance_column(const py::object& self) {
  const auto& rows = self.cast<const eval::CovarianceTable&>().rows;
  const auto count = static_cast<py::ssize_t>(rows.size());
  constexpr auto kRow = static_cast<py::ssize_t>(sizeof(eval::StampedCovariance));
  constexpr auto kDouble = static_cast<py::ssize_t>(sizeof(double));
  const double* const first = rows.empty() ? nullptr : (rows.front().*Member).data();
  return view(first, {count, 3, 3}, {kRow, kDouble, 3 * kDouble}, self);  // Eigen stores columns
}

void bind_covariances(py::module_& m) {
  using eval::CovarianceTable;
  py::class_<CovarianceTable>(m, "CovarianceTable",
                              "Covariances of poses. The arrays are read-only views of its memory.")
      .def("__len__", [](const CovarianceTable& table) { return table.rows.size(); })
      .def_property_readonly(
          "times_ns",
          [](const py::object& self) {
            const auto& rows = self.cast<const CovarianceTable&>().rows;
            const std::int64_t* const first = rows.empty() ? nullptr : &rows.front().t.ns;
            return column(std::span<const eval::StampedCovariance>(rows), first, 1, self);
          },
          "Stamps, int64 [n], ns.")
      .def_property_readonly("position", &covariance_column<&eval::StampedCovariance::position>,
                             "[n, 3, 3], m^2.")
      .def_property_readonly("rotation", &covariance_column<&eval::StampedCovariance::rotation>,
                             "[n, 3, 3], rad^2, of the rotation error about the axes of the world.");
  m.def(
      "read_covariances",
      [](const std::filesystem::path& path, const Trajectory& trajectory) {
        const py::gil_scoped_release release;
        const std::string text = eval::read_text_file(path);
        std::optional<CovarianceTable> table = eval::find_covariances(text, path.string());
        if (!table) table = eval::parse_covariances(text, path.string());
        const std::size_t columns = table->columns;
        return CovarianceTable{.rows = eval::at_poses(trajectory, *std::move(table)), .columns = columns};
      },
      py::arg("path"), py::arg("trajectory"),
      "The covariances at the poses of `trajectory`: of columns after those of the pose, or of a file of "
      "rows `t` and 6, "
      "12, 21 or 36 numbers; zero where a pose has none. Raises InputError if the file has none.");
}

template <class Pairs>
py::array pair_table(const Pairs& pairs) {
  std::vector<std::int64_t> values;
  values.reserve(2 * pairs.size());
  for (const auto& pair : pairs) values.insert(values.end(), {pair.gt, pair.est});
  return table_of(std::move(values), 2);
}

eval::AssociationOptions association_options(double max_difference_s, double offset_s,
                                             const std::string& arithmetic) {
  if (arithmetic != "exact" && arithmetic != "double")
    throw InputError("arithmetic", "unknown value \"" + arithmetic + "\"; expected one of: exact, double");
  return {
      .max_difference_s = max_difference_s,
      .offset_s = offset_s,
      .arithmetic = arithmetic == "exact" ? eval::StampArithmetic::kExact : eval::StampArithmetic::kDouble};
}

template <class Associate>
auto association(Associate associate) {
  return [associate](const Trajectory& gt, const Trajectory& est, double max_difference_s, double offset_s,
                     const std::string& arithmetic) {
    const eval::AssociationOptions options = association_options(max_difference_s, offset_s, arithmetic);
    std::vector<eval::IndexPair> pairs;
    {
      const py::gil_scoped_release release;
      pairs = associate(gt, est, options);
    }
    return pair_table(pairs);
  };
}

void bind_association(py::module_& m) {
  constexpr const char* kPairs = "Pairs of indices (ground truth, estimate), int64 [n, 2]. ";
  m.def(
      "associate_tum", association([](const Trajectory& gt, const Trajectory& est, const auto& options) {
        return eval::associate_tum(gt, est, options);
      }),
      py::arg("gt"), py::arg("est"), py::arg("max_difference_s") = 0.02, py::arg("offset_s") = 0.0,
      py::arg("arithmetic") = "exact",
      (kPairs +
       std::string("By the rule of the TUM tools: candidates less than `max_difference_s` apart, the closest "
                   "first, one-to-one. `offset_s` is added to the stamps of the estimate."))
          .c_str());
  m.def("associate_evo", association([](const Trajectory& gt, const Trajectory& est, const auto& options) {
          return eval::associate_evo(gt, est, options);
        }),
        py::arg("gt"), py::arg("est"), py::arg("max_difference_s") = 0.02, py::arg("offset_s") = 0.0,
        py::arg("arithmetic") = "exact",
        (kPairs +
         std::string(
             "By the rule of evo: each pose of the shorter trajectory with the closest of the other, at "
             "most `max_difference_s` apart."))
            .c_str());
  m.def(
      "associate_interpolated",
      [](const Trajectory& gt, const Trajectory& est, double max_gap_s, double offset_s) {
        const std::vector<eval::InterpolatedPair> pairs =
            eval::associate_interpolated(gt, est, max_gap_s, offset_s);
        std::vector<double> fractions;
        for (const eval::InterpolatedPair& pair : pairs) fractions.push_back(pair.fraction);
        return py::make_tuple(pair_table(pairs), array_of(std::move(fractions)));
      },
      py::arg("gt"), py::arg("est"), py::arg("max_gap_s"), py::arg("offset_s") = 0.0,
      "Pairs [n, 2] and fractions [n] in [0, 1): the ground truth of pair i is interpolated between its "
      "poses pairs[i, 0] "
      "and pairs[i, 0] + 1, both less than `max_gap_s` away.");
}

eval::PoseIndex checked_index(std::int64_t index, std::size_t size, std::size_t row) {
  if (index < 0 || static_cast<std::size_t>(index) >= size)
    reject_row("pairs", row,
               "has the index " + std::to_string(index) + " of " + std::to_string(size) + " poses");
  return static_cast<eval::PoseIndex>(index);
}

PoseMatches matches_of(const Trajectory& gt, const Trajectory& est, const Integers& pairs,
                       const std::optional<Doubles>& fractions) {
  require_shape(pairs, "pairs", {-1, 2});
  const auto count = static_cast<std::size_t>(pairs.shape(0));
  if (fractions) require_shape(*fractions, "fractions", {pairs.shape(0)});
  std::vector<eval::IndexPair> plain;
  std::vector<eval::InterpolatedPair> interpolated;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    const eval::IndexPair pair{checked_index(pairs.at(row, 0), gt.poses.size(), i),
                               checked_index(pairs.at(row, 1), est.poses.size(), i)};
    if (!fractions) {
      plain.push_back(pair);
      continue;
    }
    const double fraction = fractions->at(row);
    if (!(fraction >= 0.0 && fraction < 1.0) || (fraction > 0.0 && pair.gt + 1 >= gt.poses.size()))
      reject_row("fractions", i, "is not in [0, 1), or there is no later pose");
    interpolated.push_back({.gt = pair.gt, .est = pair.est, .fraction = fraction});
  }
  if (fractions) return {gt, est, std::move(interpolated)};
  return {gt, est, std::move(plain)};
}

/// Values of all matches, [n, width].
template <int width, class Values>
py::array match_table(const PoseMatches& matches, Values values_of) {
  std::vector<double> values;
  values.reserve(width * matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Matrix<double, width, 1> row = values_of(matches[i]);
    values.insert(values.end(), row.data(), row.data() + width);
  }
  return table_of(std::move(values), width);
}

void bind_matches(py::module_& m) {
  using eval::MatchedPose;
  py::class_<PoseMatches>(m, "PoseMatches",
                          "Matched poses of ground truth and estimate, at the stamps of the estimate.")
      .def(py::init(&matches_of), py::arg("gt"), py::arg("est"), py::arg("pairs"),
           py::arg("fractions") = py::none(), py::keep_alive<1, 2>(), py::keep_alive<1, 3>(),
           "From pairs of indices [n, 2]; with fractions [n] the ground truth is interpolated. Raises "
           "InputError for an "
           "index that no pose has.")
      .def("__len__", &PoseMatches::size)
      .def("align", &PoseMatches::align, py::arg("S_w_v"),
           "From now on, the estimated poses are those in the world of the ground truth.")
      .def_property_readonly(
          "times_ns",
          [](const PoseMatches& matches) {
            std::vector<std::int64_t> times;
            for (std::size_t i = 0; i < matches.size(); ++i) times.push_back(matches.time(i).ns);
            return array_of(std::move(times));
          },
          "Stamps of the estimate, int64 [n], ns.")
      .def_property_readonly(
          "gt_positions",
          [](const PoseMatches& matches) {
            return match_table<3>(matches, [](const MatchedPose& pose) { return pose.gt.p; });
          },
          "[n, 3], m.")
      .def_property_readonly(
          "est_positions",
          [](const PoseMatches& matches) {
            return match_table<3>(matches, [](const MatchedPose& pose) { return pose.est.p; });
          },
          "[n, 3], m.")
      .def_property_readonly(
          "gt_quaternions_xyzw",
          [](const PoseMatches& matches) {
            return match_table<4>(matches, [](const MatchedPose& pose) { return pose.gt.q.coeffs(); });
          },
          "[n, 4].")
      .def_property_readonly(
          "est_quaternions_xyzw",
          [](const PoseMatches& matches) {
            return match_table<4>(matches, [](const MatchedPose& pose) { return pose.est.q.coeffs(); });
          },
          "[n, 4].");
}

py::array transformed_points(const Similarity& S, const Doubles& points) {
  require_shape(points, "points", {-1, 3});
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(points.size()));
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    const Eigen::Vector3d x = S * Eigen::Vector3d(points.at(i, 0), points.at(i, 1), points.at(i, 2));
    values.insert(values.end(), x.data(), x.data() + 3);
  }
  return table_of(std::move(values), 3);
}

Trajectory transformed(const Similarity& S, const Trajectory& trajectory) {
  Trajectory result{.frame = trajectory.frame};
  result.poses.reserve(trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) result.poses.emplace_back(pose.t, S * pose.T_w_f);
  return result;
}

void bind_similarity(py::module_& m) {
  py::class_<Similarity>(m, "Similarity",
                         "x_w = scale * R_w_v * x_v + p_w_v, from the world v of an estimate to w.")
      .def(py::init([](const Doubles& translation, const Doubles& quaternion_xyzw, double scale) {
             return Similarity{
                 {quaternion_of(quaternion_xyzw, "quaternion_xyzw"), vector_of(translation, "translation")},
                 scale};
           }),
           py::arg("translation") = std::vector<double>{0, 0, 0},
           py::arg("quaternion_xyzw") = std::vector<double>{0, 0, 0, 1}, py::arg("scale") = 1.0)
      .def_readonly("scale", &Similarity::scale, "1 unless it was estimated.")
      .def_property_readonly(
          "translation", [](const Similarity& S) { return vector_array(S.T_w_v.p); }, "p_w_v, [3], m.")
      .def_property_readonly(
          "quaternion_xyzw", [](const Similarity& S) { return quaternion_array(S.T_w_v.q); }, "[4].")
      .def_property_readonly(
          "rotation", [](const Similarity& S) { return matrix_array(S.T_w_v.R()); }, "R_w_v, [3, 3].")
      .def("__mul__", &transformed_points, py::arg("points"), "Points [n, 3] of v in w, [n, 3].")
      .def("__mul__", &transformed, py::arg("trajectory"), "The trajectory in w.");
}

void bind_alignment(py::module_& m) {
  using eval::Alignment;
  Record<eval::AlignmentResult>(m, "AlignmentResult", "A fitted transform.")
      .field("S_w_v", &eval::AlignmentResult::S_w_v, "The transform.")
      .field("determined", &eval::AlignmentResult::determined,
             "Whether the positions determine it uniquely.");
  m.def(
      "align",
      [](const PoseMatches& matches, const std::string& kind, std::size_t first_n) {
        const auto alignment = value_of<Alignment>("kind", kind);
        const py::gil_scoped_release release;
        return eval::align(matches, alignment, first_n);
      },
      py::arg("matches"), py::arg("kind") = "se3", py::arg("first_n") = 0,
      "Least-squares alignment of the estimated positions; `kind` is none, first_pose, yaw, se3 or sim3. "
      "Uses the first "
      "`first_n` matches, 0 for all.");
  m.def(
      "complete_rotation",
      [](const PoseMatches& matches, const Similarity& S_w_v, const std::string& kind) {
        const eval::CompletedAlignment completed =
            eval::complete_rotation(matches, S_w_v, value_of<Alignment>("kind", kind));
        return eval::AlignmentResult{completed.S_w_v, completed.determined};
      },
      py::arg("matches"), py::arg("S_w_v"), py::arg("kind") = "se3",
      "The alignment with what positions on a line, or at one place, do not determine taken from the "
      "orientations.");
  m.def(
      "move_to_frame",
      [](const Trajectory& trajectory, const Doubles& T_f_g, const std::string& frame) {
        return eval::move_to_frame(trajectory, rigid_of(T_f_g, "T_f_g"), frame);
      },
      py::arg("trajectory"), py::arg("T_f_g"), py::arg("frame") = "",
      "The poses T_w_g = T_w_f T_f_g of the frame g; T_f_g: [4, 4].");
  m.def("missing_orientations", &eval::missing_orientations, py::arg("gt"), py::arg("est"),
        py::arg("offset_s") = 0.0, "Why errors of orientations mean nothing; empty if they can be compared.",
        py::call_guard<py::gil_scoped_release>());
}

}  // namespace

void bind_trajectories(py::module_& module) {
  bind_trajectory(module);
  bind_files(module);
  bind_covariances(module);
  bind_association(module);
  bind_similarity(module);
  bind_matches(module);
  bind_alignment(module);
}

}  // namespace stillpoint::python
