// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/hosts.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

TEST(Tool, ArgumentsAreNotReadByAShell) {
  const std::string text = "$(touch x); `id` \"'\\ * ~ > y\n";
  const ToolResult result = call_tool({.program = "printf", .arguments = {"%s", text}});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, text);
}

TEST(Tool, ExitCodeAndLastMessageAreReported) {
  const ToolResult result = call_tool({.program = "ls", .arguments = {"/does/not/exist"}});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.messages.find("/does/not/exist"), std::string::npos);
  expect_input_error([] { require_tool({.program = "false", .arguments = {}}); }, {"false", "code 1"});
}

TEST(Tool, AMissingProgramIsAnError) {
  expect_input_error([] { static_cast<void>(call_tool({.program = "no-such-program", .arguments = {}})); },
                     {"no-such-program", "not installed"});
}

TEST(Tool, PlainWordsHaveNoMeaningInAShell) {
  for (const char* word : {"a", "/usr/bin/x-1.2", "a=b", "user@host:dir/", "1,2"})
    EXPECT_TRUE(is_plain_word(word)) << word;
  for (const char* word : {"", "-a", "a b", "a;b", "$x", "`x`", "a\nb", "~", "a*", "(", "'", "\"", "a\\",
                           "\xc3\xa4", "a|b", "{}", "#"})
    EXPECT_FALSE(is_plain_word(word)) << word;
}

}  // namespace
}  // namespace stillpoint::bench
