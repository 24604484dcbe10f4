// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <fnmatch.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/data/fetch_progress.h"
#include "bench/cli/interrupt.h"
#include "bench/fetch/verify_sequences.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

struct VerifyArguments {
  std::vector<std::string> names;
  std::string root;
};

const char* state_name(VerifiedState state) {
  switch (state) {
    case VerifiedState::kEqual:
      return "unchanged";
    case VerifiedState::kChanged:
      return "CHANGED";
    case VerifiedState::kMissing:
      return "MISSING";
  }
  return "";
}

/// The registered sequences whose names match one of the patterns; all without patterns.
std::vector<RegisteredSequence> selected_registrations(const std::vector<std::string>& patterns) {
  std::vector<RegisteredSequence> selected = read_registry(registry_file());
  if (patterns.empty()) return selected;
  for (const std::string& pattern : patterns) {
    const bool is_known = std::ranges::any_of(selected, [&](const RegisteredSequence& sequence) {
      return fnmatch(pattern.c_str(), sequence.name.c_str(), 0) == 0;
    });
    if (!is_known)
      throw InputError("sequence \"" + pattern + "\"",
                       "is not registered; `stillpoint data list` shows the names");
  }
  std::erase_if(selected, [&](const RegisteredSequence& sequence) {
    return std::ranges::none_of(patterns, [&](const std::string& pattern) {
      return fnmatch(pattern.c_str(), sequence.name.c_str(), 0) == 0;
    });
  });
  return selected;
}

int verify(const VerifyArguments& arguments) {
  install_interrupt_handlers();
  FetchProgress progress;
  int findings = 0;
  int verified = 0;
  const auto print = [&](const std::string& name, VerifiedState state) {
    ++verified;
    if (state != VerifiedState::kEqual) ++findings;
    std::cout << fmt::format("{:<10} {}\n", state_name(state), name) << std::flush;
  };
  for (const RegisteredSequence& sequence : selected_registrations(arguments.names)) {
    if (interrupt_requested()) return kExitInterrupted;
    print(sequence.name + "  " + sequence.folder.string(), verify_sequence(sequence));
  }
  if (arguments.names.empty()) {
    const std::filesystem::path root =
        arguments.root.empty() ? download_root() : std::filesystem::path(arguments.root);
    for (const VerifiedFile& file : verify_archives(root, progress.control().step("verifying archives")))
      print(file.file, file.state);
  }
  if (interrupt_requested()) return kExitInterrupted;
  std::cout << fmt::format("{} verified, {} changed or missing\n", verified, findings);
  return findings == 0 ? kExitOk : kExitFindings;
}

}  // namespace

Command verify_command() {
  const auto arguments = std::make_shared<VerifyArguments>();
  return {.name = "verify",
          .summary =
              "Compare registered sequences and kept archives with the digests of their first use; exit "
              "code 1 if a file changed or is missing",
          .example = "data verify \"tum_*\"",
          .options = {{.name = "NAME",
                       .help = "Registered names or globs [all, and the archives]",
                       .target = &arguments->names,
                       .may_be_omitted = true},
                      {"--to", "Folder of downloads [$STILLPOINT_DATA, else ~/.local/share/stillpoint]",
                       &arguments->root}},
          .action = [arguments] { return verify(*arguments); }};
}

}  // namespace stillpoint::bench
