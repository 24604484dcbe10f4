// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/store_subcommand.h"
#include "bench/compare/commit_history.h"
#include "bench/config/spelling.h"
#include "bench/record/utc_time.h"
#include "bench/store/acceptance.h"
#include "bench/store/store.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

struct AcceptArguments {
  std::string store = "build/bench/store.sqlite";
  Acceptance subject;
};

/// A name that nothing in the history has would never take effect.
template <class NameOf>
void require_known(const CommitHistory& history, const std::string& option, const std::string& name,
                   NameOf name_of) {
  std::set<std::string> known;
  for (const HistorySeries& series : history.series) known.insert(name_of(series));
  if (known.contains(name)) return;
  const std::vector<std::string> names(known.begin(), known.end());
  throw InputError(option, "the store has no \"" + name + "\"" + suggestion(name, names));
}

/// The acceptance with its commit written out, after all its names were found.
Acceptance resolved(const AcceptArguments& arguments) {
  Acceptance subject = arguments.subject;
  if (subject.metric.empty())
    throw InputError("--metric", "is missing; give the name of the metric or module");
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

std::string told(const Acceptance& subject) {
  return fmt::format("{} of {} on {} at {}", subject.metric,
                     subject.variant.empty() ? "every variant" : subject.variant,
                     subject.sequence.empty() ? "every sequence" : subject.sequence, subject.commit);
}

int accept(const AcceptArguments& arguments) {
  if (arguments.subject.reason.empty())
    throw InputError("--reason", "is missing; say why the change is accepted");
  Acceptance subject = resolved(arguments);
  subject.accepted = utc_now();
  write_acceptances(arguments.store, {subject});
  std::cout << "accepted: " << told(subject) << '\n';
  return kExitOk;
}

int withdraw(const AcceptArguments& arguments) {
  const Acceptance subject = resolved(arguments);
  if (!withdraw_acceptance(arguments.store, subject))
    throw InputError("store withdraw", told(subject) + " was not accepted; see `stillpoint store accepted`");
  std::cout << "no longer accepted: " << told(subject) << '\n';
  return kExitOk;
}

int list(const AcceptArguments& arguments) {
  for (const Acceptance& acceptance : Store(arguments.store).acceptances())
    std::cout << acceptance.accepted << "  " << told(acceptance) << ": " << acceptance.reason << '\n';
  return kExitOk;
}

}  // namespace

std::vector<Command> acceptance_commands() {
  const auto arguments = std::make_shared<AcceptArguments>();
  Acceptance& subject = arguments->subject;
  const std::vector<Option> named = {
      {"COMMIT", "The commit up to which the number changed, or its beginning", &subject.commit},
      {"--metric", "Name of the metric or module, as `stillpoint regressions` has it", &subject.metric},
      {"--variant", "Only of this variant [every]", &subject.variant},
      {"--sequence", "Only on this sequence [every]", &subject.sequence}};
  std::vector<Option> with_reason = named;
  with_reason.push_back({"--reason", "Why the change is accepted", &subject.reason});
  return {
      store_subcommand("accept", "Mark a change of a number as accepted: it is no open regression any more",
                       "accept 11826db --metric state_optimization --reason \"exact solver\"", with_reason,
                       arguments, accept),
      store_subcommand("withdraw", "Take an acceptance back", "withdraw 11826db --metric state_optimization",
                       named, arguments, withdraw),
      store_subcommand("accepted", "One line for each accepted change", "accepted", {}, arguments, list)};
}

}  // namespace stillpoint
