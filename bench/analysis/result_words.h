// SPDX-License-Identifier: BSD-3-Clause
/// The words by which outputs state a result, each with its condition. The section "Result words" of
/// bench/README.md is generated from this table, and a test compares them.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillpoint::bench {

struct ResultWord {
  std::string_view output;     ///< commands that print it
  std::string_view word;       ///< as it is printed
  std::string_view condition;  ///< when
};

/// In the order of the outputs.
[[nodiscard]] std::span<const ResultWord> result_words();

/// The table as Markdown.
[[nodiscard]] std::string result_words_markdown();

}  // namespace stillpoint::bench
