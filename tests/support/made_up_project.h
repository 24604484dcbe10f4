// SPDX-License-Identifier: BSD-3-Clause
/// A git repository of a made-up SLAM system with 12 commits, its description, and a plan.
#pragma once

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sequences/fake_sequence.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {

/// Commits from 1 on: 4 is slower by 30 %, 7 has an error of 0.015 instead of 0.01 m, 8 cannot be built, and
/// from 10 on one in 20 repetitions crashes. Commits 2k and 2k + 1 have the same time. Error and time of each
/// run scatter by 1 %.
class MadeUpProject {
 public:
  MadeUpProject() {
    folder_.write("make.sh", R"SH(
set -e
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_NOSYSTEM=1
mkdir repository
cd repository
git init -q -b main
cat >slam.sh <<'END'
[ "$CRASHES" = 0 ] || [ $(($3 % 20)) != 3 ] || kill -SEGV $$
awk -v e="$ERROR" -v r="$3" -v n="$NUMBER" '
  { printf "%s %s %s %.9f 0 0 0 1\n", $1, $2, $3, e * (1 + 0.01 * sin(7 * r + n)) * sin(0.5 * NR) }
' "$1/groundtruth.txt" >"$2/trajectory.tum"
awk -v t="$MS" -v r="$3" -v n="$NUMBER" 'BEGIN {
  t *= 1 + 0.01 * sin(5 * r + n)
  printf "{\"modules\": {\"tracking\": {\"mean\": %f, \"median\": %f, \"p95\": %f, \"max\": %f, \"calls\": 60}}, ", t, t, t, t
  print "\"threads\": {}}"
}' >"$2/timings.json"
END
cat >build.sh <<'END'
. ./parameters
[ "$BUILDS" = 1 ] || { echo "error: no such header" >&2; exit 1; }
mkdir -p out
{ echo '#!/bin/sh'; cat parameters slam.sh; } >out/slam
chmod +x out/slam
END
for i in 1 2 3 4 5 6 7 8 9 10 11 12; do
  ms=10 error=0.01 builds=1 crashes=0
  [ $i -lt 4 ] || ms=13
  [ $i -lt 7 ] || error=0.015
  [ $i -ne 8 ] || builds=0
  [ $i -lt 10 ] || crashes=1
  printf 'NUMBER=%s MS=%s ERROR=%s BUILDS=%s CRASHES=%s\n' $i $ms $error $builds $crashes >parameters
  git add .
  export GIT_COMMITTER_DATE="2024-01-01T00:$((10 + i / 2)):00Z" GIT_AUTHOR_DATE="2024-01-01T00:00:00Z"
  git -c user.name=t -c user.email=t@example.org commit -q -m "Change $i"
  git rev-parse HEAD >>../commits
done
)SH");
    if (std::system(("cd '" + folder_.path().string() + "' && sh make.sh").c_str()) != 0)
      throw std::runtime_error("the repository cannot be made");
    std::ifstream lines(folder_.path() / "commits");
    for (std::string line; std::getline(lines, line);) commits_.push_back(line);
    fake_sequence(folder_, "freiburg1_a");
    folder_.write("slam.toml", R"(name = "slam"
command = ["{binary}", "{sequence}", "{out}", "{repetition}"]
layout = "as_is"
timings = "timings.json"
[source]
git = "repository"
build = ["sh", "build.sh"]
binary = "out/slam"
)");
    folder_.write("plan.toml", "repetitions = 2\nimages = 0\n[recorded]\nsequences = [\"freiburg1_a\"]\n");
  }

  /// Path of a file in the folder.
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

  /// @param number from 1 on
  [[nodiscard]] const std::string& commit(std::size_t number) const { return commits_.at(number - 1); }

  /// What a command needs to find the sequence.
  [[nodiscard]] std::vector<std::string> environment() const {
    return {"STILLPOINT_DATA=" + folder_.path().string(), "STILLPOINT_REGISTRY=" + file("none.json"),
            "STILLPOINT_CACHE=" + file("cache")};
  }

  /// Executes a command of the program with the system and the plan.
  [[nodiscard]] ProgramResult run(std::vector<std::string> arguments, ProgramOptions options = {}) const {
    options.environment = environment();
    return run_program(arguments, options);
  }

 private:
  TemporaryFolder folder_;
  std::vector<std::string> commits_;
};

}  // namespace stillpoint
