// SPDX-License-Identifier: BSD-3-Clause
// Numbers that no command can compute with are rejected with the name of the option and its range.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/rejection.h"

namespace stillpoint {
namespace {

/// A number option with a value out of its range. The other arguments of the command need not exist, as
/// options are checked first.
struct NumberOption {
  std::vector<std::string> command;
  std::string option;
  std::string value;
};

const NumberOption kOptions[] = {
    {{"run", "seq"}, "--speed", "nan"},
    {{"run", "seq"}, "--passes", "0"},
    {{"run", "seq"}, "--every", "0"},
    {{"run", "seq"}, "--images", "-1"},
    {{"run", "seq"}, "--max-frames", "-1"},
    {{"profile", "seq"}, "--speed", "inf"},
    {{"profile", "seq"}, "--frame-budget-ms", "0"},
    {{"profile", "seq"}, "--max-frames", "1e30"},
    {{"detect", "seq"}, "--max-frames", "-1"},
    {{"bench", "quick"}, "--jobs", "0"},
    {{"reproduce", "table1"}, "--jobs", "-1"},
    {{"compare", "a", "b"}, "--pairs", "0"},
    {{"serve", "store"}, "--port", "65536"},
    {{"eval", "gt", "est"}, "--offset", "nan"},
    {{"eval", "gt", "est"}, "--offset", "-inf"},
    {{"eval", "gt", "est"}, "--offset", "1e30"},
    {{"eval", "gt", "est"}, "--max-difference", "-1"},
    {{"eval", "gt", "est"}, "--max-difference", "0"},
    {{"eval", "gt", "est"}, "--align-first", "0"},
    {{"eval", "gt", "est"}, "--rpe-delta", "nan"},
    {{"eval", "gt", "est"}, "--seq", "-1"},
    {{"data", "synth", "market"}, "--seed", "-1"},
    {{"data", "synth", "market"}, "--seconds", "nan"},
    {{"data", "synth", "market"}, "--people", "-5"},
    {{"data", "synth", "market"}, "--seated", "-5"},
    {{"data", "synth", "market"}, "--unknown", "-5"},
    {{"data", "synth", "market"}, "--start", "inf"},
    {{"data", "synth", "market"}, "--width", "0"},
    {{"data", "synth", "market"}, "--height", "1e30"},
    {{"data", "synth", "market"}, "--focal", "-1"},
    {{"data", "synth", "market"}, "--rate", "nan"},
    {{"data", "synth", "market"}, "--exposure-ms", "-1"},
    {{"data", "synth", "market"}, "--exposure-swing", "nan"},
    {{"data", "synth", "market"}, "--rolling-shutter-ms", "inf"},
    {{"data", "synth", "market"}, "--depth-noise", "nan"},
    {{"data", "synth", "market"}, "--time-offset-ms", "nan"},
    {{"data", "synth", "market"}, "--dropped", "-1"},
    {{"data", "synth", "market"}, "--depth-units", "nan"},
    {{"data", "synth", "market"}, "--track-sequence", "-1"},
    {{"data", "synth", "market"}, "--threads", "-1"},
};

TEST(NumberOptions, RejectNumbersOutsideTheirRange) {
  for (const NumberOption& option : kOptions) {
    std::vector<std::string> arguments = option.command;
    arguments.push_back(option.option + "=" + option.value);
    SCOPED_TRACE(option.command.front() + " " + arguments.back());
    expect_rejected(run_program(arguments), {option.option, "must be from", "not " + option.value});
  }
}

}  // namespace
}  // namespace stillpoint
