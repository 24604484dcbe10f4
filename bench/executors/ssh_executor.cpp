// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/ssh_executor.h"

#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "bench/executors/host_package.h"
#include "bench/executors/job_folder.h"
#include "bench/executors/tool.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kUnreachable = 255;  // exit code of ssh if it cannot connect

using Words = std::vector<std::string>;

class SshHosts {
 public:
  SshHosts(const PlanMatrix& matrix, const DistributionOptions& options, const SshOptions& ssh)
      : options_(options), hosts_(ssh.hosts), folder_(job_folder(matrix.plan, options.store)) {
    if (!options.machine_class.empty()) {
      std::erase_if(hosts_, [&](const Host& host) { return host.machine_class != options.machine_class; });
      if (hosts_.empty()) throw InputError("--hosts", "no host has the class " + options.machine_class);
    }
    if (!ssh.config.empty()) ssh_ = {"ssh", "-F", fs::absolute(ssh.config).string()};
    if (!is_plain_word(ssh_.back()))
      throw InputError("--ssh-config", "the path may only have letters, digits and _ . / + , = @ : -");
    remote_ = ".stillpoint/jobs/" + folder_.filename().string();
    if (matrix.plan.kind == RunKind::kTiming) {
      for (Host& host : hosts_) host.tasks = 1;
    }
    for (const PlanSequence& sequence : matrix.sequences) {
      if (!sequence.rendering && sequence.unavailable_reason.empty())
        recorded_[sequence.name] = sequence.folder;
    }
  }

  /// Also leaves out hosts that cannot be reached.
  void collect() {
    std::erase_if(hosts_, [&](const Host& host) { return !stopped() && !is_reachable(host); });
    if (hosts_.empty()) throw InputError("--hosts", "no host can be reached; try `ssh HOST true`");
    for (const Host& host : hosts_) {
      if (!stopped() && !programs_.contains(host.name)) programs_[host.name] = install_program(host);
      if (!stopped()) collect_from(host);
    }
  }

  void execute(int tasks) const {
    for (const Host& host : hosts_) prepare(host);
    std::string logins;
    for (const Host& host : hosts_) logins += fmt::format("{}/{}\n", host.tasks, host.name);
    write_files(folder_, {{"logins", logins}});
    report(fmt::format("{} tasks on {} hosts", tasks, hosts_.size()));
    Words arguments = {"--will-cite",      "--retries", "2",          "--sshloginfile",
                       folder_ / "logins", "--ssh",     ssh_command()};
    // parallel gives these words to a shell on both sides; all of them are plain.
    for (const std::string& word : worker_words({"run"})) arguments.push_back(word);
    arguments.insert(arguments.end(), {"{}", "--jobs", std::to_string(options_.jobs), ":::"});
    for (int task = 1; task <= tasks; ++task) arguments.push_back(std::to_string(task));
    const ToolResult result =
        call_tool({.program = "parallel", .arguments = arguments, .stop_requested = options_.stop_requested});
    if (result.exit_code != 0)
      report(fmt::format("parallel exited with code {}: {}", result.exit_code, result.messages));
  }

 private:
  [[nodiscard]] bool stopped() const { return options_.stop_requested && options_.stop_requested(); }
  void report(const std::string& step) const {
    if (options_.on_step) options_.on_step(step);
  }

  /// The command of ssh as one text, which rsync and parallel split at its spaces.
  [[nodiscard]] std::string ssh_command() const {
    std::string command;
    for (const std::string& word : ssh_) command += word + " ";
    return command + "-oBatchMode=yes";
  }

  /// Command line of this program on a host; the words are plain.
  [[nodiscard]] Words worker_words(const Words& subcommand) const {
    Words words = {remote_ + "/program", "worker"};
    words.insert(words.end(), subcommand.begin(), subcommand.end());
    words.push_back(remote_);
    return words;
  }

  [[nodiscard]] ToolResult call_ssh(const Host& host, const Words& words) const {
    Words arguments(ssh_.begin() + 1, ssh_.end());
    arguments.insert(arguments.end(), {"-oBatchMode=yes", host.name, "--"});
    for (const std::string& word : words) {
      if (!is_plain_word(word) && word != "-p")
        throw InputError("ssh", "\"" + word + "\" is not a plain word");
      arguments.push_back(word);
    }
    return call_tool({.program = "ssh", .arguments = arguments, .stop_requested = options_.stop_requested});
  }

  void require_rsync(const Words& options, const std::string& from, const std::string& to) const {
    Words arguments = {"--archive", "--rsh=" + ssh_command()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.insert(arguments.end(), {"--", from, to});
    require_tool({.program = "rsync", .arguments = arguments, .stop_requested = options_.stop_requested});
  }

  [[nodiscard]] std::string remote_path(const Host& host, const std::string& name) const {
    return host.name + ":" + remote_ + "/" + name;
  }

  [[nodiscard]] bool is_reachable(const Host& host) const {
    const ToolResult result = call_ssh(host, {"mkdir", "-p", remote_});
    if (result.exit_code == kUnreachable)
      report(fmt::format("host {} is left out: {}", host.name, result.messages));
    else if (result.exit_code != 0)
      throw InputError("host " + host.name, "cannot create ~/" + remote_ + ": " + result.messages);
    return result.exit_code == 0;
  }

  /// The program of a host as seen from its job folder; copies the package of the host.
  [[nodiscard]] std::string install_program(const Host& host) const {
    if (host.package.empty()) return host.program;
    const HostPackage package = extract_package(host.package, folder_ / "packages", options_.stop_requested);
    if (stopped()) return {};
    const std::string target = ".stillpoint/packages/" + package.name;
    report(fmt::format("copy {} to {}", host.package, host.name));
    static_cast<void>(call_ssh(host, {"mkdir", "-p", target}));
    require_rsync({"--delete"}, package.tree.string() + "/", host.name + ":" + target + "/");
    return "../../packages/" + package.name + "/" + package.program;
  }

  /// Fetches and merges what workers of an earlier call completed, after the last one ended.
  void collect_from(const Host& host) const {
    const std::string& program = programs_.at(host.name);
    const fs::path link = folder_ / "programs" / host.name / "program";
    fs::create_directories(link.parent_path());
    fs::remove(link);
    fs::create_symlink(program, link);  // rsync copies the link itself
    require_rsync({}, link, remote_path(host, "program"));
    const ToolResult waited = call_ssh(host, worker_words({"wait"}));
    if (stopped()) return;
    if (waited.exit_code != 0)
      throw InputError("host " + host.name,
                       fmt::format("{} cannot be executed: {}", program, waited.messages));
    const fs::path results = folder_ / "results" / host.name;
    fs::create_directories(results);
    require_rsync({"--include=/store-*", "--include=/store-*/**", "--exclude=*"}, remote_path(host, ""),
                  results.string() + "/");
    if (!stopped()) merge_tasks(results, options_.store);
  }

  /// Copies the job to a host, and the recorded sequences if it lacks them.
  void prepare(const Host& host) const {
    // Stores of an earlier job were collected; --delete removes them.
    require_rsync({"--delete", "--exclude=/data", "--exclude=/program"}, (folder_ / "job").string() + "/",
                  remote_path(host, ""));
    ToolResult check = call_ssh(host, worker_words({"check"}));
    if (check.exit_code != 0 && !recorded_.empty() && !stopped()) {
      copy_sequences(host);
      check = call_ssh(host, worker_words({"check"}));
    }
    if (check.exit_code != 0 && !stopped()) throw InputError("host " + host.name, check.messages);
  }

  void copy_sequences(const Host& host) const {
    for (const auto& [name, folder] : recorded_) {
      if (!is_plain_word(name))
        throw InputError("sequence \"" + name + "\"",
                         "cannot be copied; register it under a name of letters, "
                         "digits and _ . - with `stillpoint data add`");
      report(fmt::format("copy {} to {}", name, host.name));
      static_cast<void>(call_ssh(host, {"mkdir", "-p", remote_ + "/data/" + name}));
      require_rsync({"--copy-links", "--delete"}, folder.string() + "/",
                    remote_path(host, "data/" + name + "/"));
    }
  }

  DistributionOptions options_;
  std::vector<Host> hosts_;
  fs::path folder_;
  Words ssh_ = {"ssh"};
  std::string remote_;                           ///< the job folder on each host, relative to the home folder
  std::map<std::string, std::string> programs_;  ///< of the hosts, as seen from their job folders
  std::map<std::string, fs::path> recorded_;
};

}  // namespace

Executor ssh_executor(const PlanMatrix& matrix, const DistributionOptions& options, const SshOptions& ssh) {
  const auto hosts = std::make_shared<SshHosts>(matrix, options, ssh);
  return {.collect = [hosts] { hosts->collect(); }, .execute = [hosts](int tasks) { hosts->execute(tasks); }};
}

}  // namespace stillpoint::bench
