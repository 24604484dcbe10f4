// SPDX-License-Identifier: BSD-3-Clause
/// What may limit the accuracy on a recording.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/diagnose/correction.h"

namespace stillpoint::bench {

/// Strength of wrong units and axes, whose consequences look like other causes.
inline constexpr double kFundamental = 500.0;

/// What a candidate is known by.
enum class CauseBasis {
  kShown,     ///< the data itself, e.g. blank frames
  kCompared,  ///< sensors that contradict each other, by several standard deviations
  kInferred,  ///< a run of the odometry, which any other fault disturbs
};

/// A candidate cause with its evidence. Without correction and times its effect cannot be measured.
struct Cause {
  std::string id;                          ///< for programs, such as "gyro_unit"
  std::string name;                        ///< such as "gyroscope in deg/s"
  std::string evidence;                    ///< one phrase with numbers
  std::string remedy;                      ///< option or entry of a file
  double strength = 0.0;                   ///< order of the candidates until their effects are measured
  std::optional<Correction> correction{};  ///< what undoes it, if that is possible
  /// Of the frames concerned, where it cannot be undone: the error outside of them is compared with that of
  /// all.
  std::vector<Timestamp> times{};
  CauseBasis basis = CauseBasis::kCompared;
  bool needs_effect = false;   ///< without one it is not listed: most sound recordings have the evidence
  double largest_ratio = 0.9;  ///< `error_ratio` up to which the effect counts
  bool consistent = true;      ///< whether all runs show the effect
  /// Error with the correction, or outside of the frames, to that as it is.
  std::optional<double> error_ratio{};

  /// Whether the data itself shows it, or units or axes are wrong: what no effect can refute.
  [[nodiscard]] bool is_certain() const { return basis == CauseBasis::kShown || strength >= kFundamental; }
  /// Whether its correction increases the error by more than chance.
  /// @param effective ratio of errors that counts, see `Diagnosis::least_effect`
  [[nodiscard]] bool is_refuted(double effective) const {
    return !is_certain() && error_ratio.value_or(1.0) * effective > 1.0;
  }
};

}  // namespace stillpoint::bench
