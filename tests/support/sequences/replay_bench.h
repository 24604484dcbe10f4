// SPDX-License-Identifier: BSD-3-Clause
/// Benchmarks of the replay system (replay_program.cpp) over two sequences.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sequences/fake_sequence.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {

/// Writes a plan, its sequences and its system definition into a folder.
/// @param flags  options of the replay program: quoted TOML strings, each followed by a comma
/// @param limits additional lines of the plan
inline std::filesystem::path write_replay_plan(const TemporaryFolder& folder, int repetitions,
                                               const std::string& flags, const std::string& limits = "") {
  fake_sequence(folder, "freiburg1_a");
  fake_sequence(folder, "freiburg1_b");
  folder.write(
      "replay.toml",
      "name = \"replay\"\nversion = \"1\"\nlayout = \"as_is\"\ntimings = \"result.json\"\ncommand = [\"" +
          std::string(STILLPOINT_BINARY_DIR "/tests/replay_program") + "\", " + flags +
          "\"run\", \"{sequence}\", \"--out\", \"{out}\", \"--set\", \"{seed}-{repetition}\"]\n");
  return folder.write("plan.toml", "title = \"Replays\"\nsystems = [\"" +
                                       (folder.path() / "replay.toml").string() +
                                       "\"]\nrepetitions = " + std::to_string(repetitions) + "\n" + limits +
                                       "[recorded]\nsequences = [\"freiburg1_*\"]\n");
}

inline std::vector<std::string> replay_arguments(const TemporaryFolder& folder,
                                                 const std::filesystem::path& plan,
                                                 const std::filesystem::path& store) {
  return {"bench",  plan.string(), "--store", store.string(),
          "--jobs", "2",           "--out",   (folder.path() / "out").string()};
}

/// Runs the plan with `folder` as STILLPOINT_DATA.
inline ProgramResult replay_bench(const TemporaryFolder& folder, const std::filesystem::path& plan,
                                  const std::filesystem::path& store, ProgramOptions options = {}) {
  options.environment = {"STILLPOINT_DATA=" + folder.path().string(),
                         "STILLPOINT_REGISTRY=" + (folder.path() / "none.json").string()};
  return run_program(replay_arguments(folder, plan, store), options);
}

}  // namespace stillpoint
