// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/result_words.h"

#include <fmt/format.h>

namespace stillpoint::bench {
namespace {

constexpr std::string_view kCompare = "compare, report";
constexpr std::string_view kHistory = "dashboard, regressions";
constexpr std::string_view kStatus = "run, bench, store, report";
constexpr std::string_view kFaults = "stats faults";
constexpr std::string_view kTables = "all tables";

constexpr ResultWord kWords[] = {
    {kCompare, "same",
     "the 95 % interval of the change lies within the margin, or that of the difference within the floor; "
     "without an interval: no pair that differs by the floor changed by more than the margin (error of this "
     "odometry), or at all (cost, or error of another system or in real time)"},
    {kCompare, "better",
     "change for the better of at least margin and floor, p <= level or exact; fewer failures"},
    {kCompare, "inconclusive",
     "none of the other words: too few runs, too much noise, no result, or something was not measured alike"},
    {kCompare, "changed, inconclusive", "the estimate exceeds margin and floor, but p > level"},
    {kCompare, "missing in HEAD",
     "head lacks a variant, sequence, metric or module, or its value is absent or infinite in all runs or "
     "significantly more often than at base"},
    {kCompare, "allowed", "missing in HEAD, with --allow-missing"},
    {kCompare, "worse",
     "change for the worse of at least margin and floor, p <= level or exact; or runs fail more often at "
     "head"},
    {kCompare, "exact",
     "in place of p: counted instructions, or all repetitions of each side are bit-equal (two or more, of "
     "other systems three, of several sequences more); the difference is a fact about this sequence, "
     "without a test"},
    {kCompare, "error", "all runs failed on both sides"},
    {kCompare, "reported only",
     "does not decide: a cost of runs that were not made to measure it, a time that is unlike, or too few "
     "runs "
     "on one sequence, which are pooled instead"},
    {kCompare, "changed, reported only", "as before; the estimate exceeds margin and floor"},
    {kCompare, "not compared: unlike",
     "other data of one name, number of frames, kind, mode, cores, seeds, protocol, unit, machine, or order "
     "of measurement"},
    {kHistory, "open", "a level shift for the worse that lasts up to the newest commit, or a missing result"},
    {kHistory, "accepted", "open, and covered by `store accept`"},
    {kHistory, "resolved", "a level shift for the worse; the newest level is as good as the one before it"},
    {kHistory, "improved", "a level shift for the better"},
    {kHistory, "neutral", "a level shift of a metric that is not compared"},
    {kHistory, "new", "a change from 0, which has no ratio, or runs that fail newly"},
    {kHistory, "no value", "the newest successful runs lack the metric, or most of them"},
    {kHistory, "other data", "the sequence continues with other data of the same name"},
    {kHistory, "not measured",
     "the newest commit lacks the subject, but has most that were measured with it"},
    {kHistory, "worse, better", "direction of a drift: a linear trend beyond the margin in sum, p <= 0.005"},
    {kHistory, "No open regressions.", "nothing is open; what the history can show follows"},
    {kStatus, "ok", "all frames were processed, and there are two poses or more"},
    {kStatus, "lost, failed",
     "all frames were processed with fewer than two poses, or with none in the time of the frames; "
     "\"failed\" in result.json and tables"},
    {kStatus, "interrupted", "stopped on request; only in result.json"},
    {kStatus, "crashed", "terminated by a signal, or exited with an error"},
    {kStatus, "timed_out", "terminated at the time limit of the plan"},
    {kStatus, "out_of_memory", "exceeded the memory limit of the plan"},
    {kStatus, "bad_data", "the sequence or the config is invalid"},
    {kStatus, "skipped", "the sequence is not available, and the plan does not require it"},
    {kStatus, "not run", "the plan has the run, the store has not"},
    {kFaults, "survive",
     "recovered in the same world, with the error and the false confidence of the limits"},
    {kFaults, "lose", "not recovered, but false confidence within the limit"},
    {kFaults, "wrong", "false confidence beyond the limit"},
    {"stats repeat", "bit-equal", "all repetitions succeeded, with one trajectory"},
    {kTables, "n/a", "no data, or none that mean something"},
    {kTables, "- (n = N), no interval", "too few values for an interval: below 6 at 95 %, or 4 per side"},
    {"eval", "not determined", "the data do not determine the value, e.g. a time offset; the reason follows"},
};

}  // namespace

std::span<const ResultWord> result_words() { return kWords; }

std::string result_words_markdown() {
  std::string text = "| output | word | condition |\n|---|---|---|\n";
  for (const ResultWord& word : kWords)
    text += fmt::format("| {} | {} | {} |\n", word.output, word.word, word.condition);
  return text;
}

}  // namespace stillpoint::bench
