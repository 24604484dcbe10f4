// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "bench/analysis/commit_history.h"
#include "bench/cli/analysis/store_subcommand.h"
#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/config/spelling.h"
#include "bench/model/utc_time.h"
#include "bench/store/acceptance.h"
#include "bench/store/store.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

struct AcceptArguments {
  std::string store = "build/bench/store.sqlite";
  Acceptance subject;
};

/// @throws InputError if `name` does not occur in the history, as the acceptance would then have no effect
template <class NameOf>
void require_known(const CommitHistory& history, const std::string& option, const std::string& name,
                   NameOf name_of) {
  std::set<std::string> known;
  for (const HistorySeries& series : history.series) known.insert(name_of(series));
  if (known.contains(name)) return;
  const std::vector<std::string> names(known.begin(), known.end());
  throw InputError(option, "\"" + name + "\" does not occur in the store" + suggestion(name, names));
}

/// Checks all names of the acceptance and expands its abbreviated commit.
Acceptance resolved(const AcceptArguments& arguments) {
  Acceptance subject = arguments.subject;
  if (subject.metric.empty()) throw InputError("--metric", "is required: the name of the metric or module");
  const CommitHistory history = commit_history(Store(arguments.store));
  subject.commit = history.commits[find_commit(history, subject.commit)].name;
  require_known(history, "--metric", subject.metric,
                [](const HistorySeries& series) { return series.metric; });
  if (!subject.variant.empty()) {
    require_known(history, "--variant", subject.variant,
                  [](const HistorySeries& series) { return series.subject.variant; });
  }
  if (!subject.sequence.empty()) {
    require_known(history, "--sequence", subject.sequence,
                  [](const HistorySeries& series) { return series.subject.sequence; });
  }
  return subject;
}

std::string describe(const Acceptance& subject) {
  return fmt::format("{} of {} on {} at {}", subject.metric,
                     subject.variant.empty() ? "all variants" : subject.variant,
                     subject.sequence.empty() ? "all sequences" : subject.sequence, subject.commit);
}

int accept(const AcceptArguments& arguments) {
  if (arguments.subject.reason.empty())
    throw InputError("--reason", "is required: why the change is accepted");
  Acceptance subject = resolved(arguments);
  subject.accepted = utc_now();
  write_acceptances(arguments.store, {subject});
  std::cout << "accepted: " << describe(subject) << '\n';
  return kExitOk;
}

int withdraw(const AcceptArguments& arguments) {
  const Acceptance subject = resolved(arguments);
  if (!withdraw_acceptance(arguments.store, subject))
    throw InputError("store withdraw",
                     describe(subject) + " was not accepted; see `stillpoint store accepted`");
  std::cout << "no longer accepted: " << describe(subject) << '\n';
  return kExitOk;
}

int list(const AcceptArguments& arguments) {
  for (const Acceptance& acceptance : Store(arguments.store).acceptances())
    std::cout << acceptance.accepted << "  " << describe(acceptance) << ": " << acceptance.reason << '\n';
  return kExitOk;
}

}  // namespace

std::vector<Command> acceptance_commands() {
  const auto arguments = std::make_shared<AcceptArguments>();
  Acceptance& subject = arguments->subject;
  const std::vector<Option> subject_options = {
      {"COMMIT", "Last commit of the range in which the metric changed; may be abbreviated", &subject.commit},
      {"--metric", "Name of the metric or module as printed by `stillpoint regressions`", &subject.metric},
      {"--variant", "Only this variant [all]", &subject.variant},
      {"--sequence", "Only this sequence [all]", &subject.sequence}};
  std::vector<Option> with_reason = subject_options;
  with_reason.push_back({"--reason", "Why the change is accepted", &subject.reason});
  return {store_subcommand(
              {.name = "accept",
               .summary = "Mark a metric change as accepted, so that it is no open regression",
               .example = "store accept 11826db --metric state_optimization --reason \"exact solver\"",
               .options = with_reason},
              arguments, accept),
          store_subcommand({.name = "withdraw",
                            .summary = "Withdraw an acceptance",
                            .example = "store withdraw 11826db --metric state_optimization",
                            .options = subject_options},
                           arguments, withdraw),
          store_subcommand({.name = "accepted",
                            .summary = "List all accepted changes, one per line",
                            .example = "store accepted"},
                           arguments, list)};
}

}  // namespace stillpoint::bench
