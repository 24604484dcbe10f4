// SPDX-License-Identifier: BSD-3-Clause
/// Command line arguments of `eval`.
#pragma once

#include <string>
#include <vector>

#include "bench/cli/command_line.h"
#include "eval/protocols/protocol.h"

namespace stillpoint::bench {

struct EvalArguments {
  std::string ground_truth;
  std::vector<std::string> estimates;
  std::vector<std::string> protocols;
  std::string alignment;
  int align_first = 0;
  double rpe_delta = 1.0;
  std::string rpe_unit = "s";
  double offset_s = 0.0;
  double max_difference_s = 0.0;
  std::string format;
  std::string times;
  int sequence = 0;
  std::string level;
  bool find_offset = false;
  bool explain = false;
  bool json = false;
  bool csv = false;
  bool markdown = false;
  std::string plot;
  std::string map;
  std::string per_pose;
  bool force = false;
};

[[nodiscard]] eval::ProtocolOptions protocol_options(const EvalArguments& arguments);

/// @param a receives the values when the command line is parsed
[[nodiscard]] std::vector<Option> options_of(EvalArguments& a);

}  // namespace stillpoint::bench
