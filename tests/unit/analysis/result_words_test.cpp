// SPDX-License-Identifier: BSD-3-Clause
// Each word that an output states as a result is in one table, and the table is in bench/README.md.
#include "bench/analysis/result_words.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "bench/analysis/history_changes.h"
#include "bench/analysis/metric_change.h"
#include "bench/model/stored_run.h"

namespace stillpoint::bench {
namespace {

bool is_listed(const std::string& word) {
  for (const ResultWord& entry : result_words()) {
    std::istringstream words{std::string(entry.word)};
    if (entry.word == word) return true;
    for (std::string part; std::getline(words, part, ',');) {
      if (part.substr(part.find_first_not_of(' ')) == word) return true;
    }
  }
  return false;
}

TEST(ResultWords, ContainAllClassesStatesAndOutcomes) {
  for (int i = 0; i <= static_cast<int>(ChangeClass::kError); ++i)
    EXPECT_TRUE(is_listed(change_class_name(static_cast<ChangeClass>(i)))) << i;
  for (int i = 0; i <= static_cast<int>(ChangeState::kNeutral); ++i)
    EXPECT_TRUE(is_listed(state_name(static_cast<ChangeState>(i)))) << i;
  for (int i = 0; i <= static_cast<int>(Outcome::kBadData); ++i) {
    EXPECT_TRUE(is_listed(outcome_name(static_cast<Outcome>(i)))) << i;
    EXPECT_TRUE(is_listed(status_name(static_cast<Outcome>(i)))) << i;
  }
  EXPECT_FALSE(is_listed("fine"));
}

TEST(ResultWords, HaveOneConditionPerOutput) {
  std::set<std::string> keys;
  for (const ResultWord& word : result_words()) {
    EXPECT_TRUE(keys.insert(std::string(word.output) + ": " + std::string(word.word)).second) << word.word;
    EXPECT_FALSE(word.condition.empty()) << word.word;
  }
}

TEST(ResultWords, AreInTheReadme) {
  std::ostringstream readme;
  readme << std::ifstream(STILLPOINT_SOURCE_DIR "/bench/README.md").rdbuf();
  EXPECT_NE(readme.str().find(result_words_markdown()), std::string::npos)
      << "replace the table of the section \"Result words\" by:\n"
      << result_words_markdown();
}

}  // namespace
}  // namespace stillpoint::bench
