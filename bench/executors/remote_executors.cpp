// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/remote_executors.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/process/child_process.h"
#include "bench/record/output_folder.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kUnreachable = 255;  // exit code of ssh if it cannot connect

using Words = std::vector<std::string>;

/// Merges the stores of tasks into that of the caller, and names results that arrived twice and differ.
void collect_tasks(const fs::path& folder, const DistributionOptions& options) {
  const MergeReport merged = merge_tasks(folder, options.store);
  if (merged.contradicting.empty() || !options.on_step) return;
  options.on_step(fmt::format("{} arrived twice with different results, of which the first are kept: {}",
                              counted(merged.contradicting.size(), "run"),
                              fmt::join(merged.contradicting, ", ")));
}

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
    report(fmt::format("{} on {}", counted(static_cast<std::size_t>(tasks), "task"),
                       counted(hosts_.size(), "host")));
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
    const ToolResult result =
        call_tool({.program = "rsync", .arguments = arguments, .stop_requested = options_.stop_requested});
    if (result.exit_code == 0 || stopped()) return;
    throw InputError("rsync from " + from + " to " + to,
                     fmt::format("exited with code {}: {}; check the connection and the space on both "
                                 "sides, and run the command again",
                                 result.exit_code, result.messages));
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
    if (!stopped()) collect_tasks(results, options_);
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
      const bool is_bag = fs::is_regular_file(folder);
      if (is_bag && fs::path(name).extension() != folder.extension())
        throw InputError("sequence \"" + name + "\"",
                         "is a bag and cannot be copied under a name without its ending; register it as " +
                             name + folder.extension().string());
      const std::string target = "data/" + name;
      static_cast<void>(call_ssh(host, {"mkdir", "-p", remote_ + (is_bag ? "/data" : "/" + target)}));
      require_rsync({"--copy-links", "--delete"}, folder.string() + (is_bag ? "" : "/"),
                    remote_path(host, target + (is_bag ? "" : "/")));
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

namespace {

// Slurm passes the words after the script to it as they are, so nothing is inserted into the texts.
constexpr const char* kTaskScript =
    "#!/bin/sh\n"
    "# task.sh PROGRAM FOLDER JOBS: executes the array task of a plan\n"
    "exec \"$1\" worker run \"$2\" \"$SLURM_ARRAY_TASK_ID\" --jobs \"$3\"\n";
constexpr const char* kMergeScript =
    "#!/bin/sh\n"
    "# merge.sh PROGRAM FOLDER STORE: merges the stores of all tasks\n"
    "exec \"$1\" worker merge \"$2\" --store \"$3\"\n";

/// The jobs of one plan.
class SlurmJobs {
 public:
  SlurmJobs(const PlanMatrix& matrix, const DistributionOptions& options)
      : options_(options), kind_(matrix.plan.kind), folder_(job_folder(matrix.plan, options.store)) {
    // sbatch replaces %a etc. in names of output files, and a backslash prevents that.
    if (folder_.string().find_first_of("%\\\n") != std::string::npos)
      throw InputError(options.store.string(),
                       "Slurm replaces characters of its path; use one without % and \\");
  }

  void collect() const {
    const std::vector<std::string> active = active_jobs();
    if (!active.empty()) {
      report(fmt::format("wait for Slurm jobs {} of an earlier call", fmt::join(active, ", ")));
      submit_merge(active);
    }
    if (stopped()) return;
    fs::create_directories(folder_ / "job");
    collect_tasks(folder_ / "job", options_);
  }

  void execute(int tasks) const {
    write_files(folder_, {{"task.sh", kTaskScript}, {"merge.sh", kMergeScript}});
    std::vector<std::string> arguments = {"--requeue",
                                          fmt::format("--array=1-{}", tasks),
                                          fmt::format("--cpus-per-task={}", options_.jobs),
                                          "--job-name=stillpoint",
                                          "--output=" + (folder_ / "task-%a.log").string(),
                                          "--open-mode=append"};
    if (kind_ == RunKind::kTiming) arguments.emplace_back("--exclusive");
    if (!options_.machine_class.empty()) arguments.push_back("--constraint=" + options_.machine_class);
    const std::string array = submit(
        arguments, {folder_ / "task.sh", executable_path(), folder_ / "job", std::to_string(options_.jobs)});
    write_files(folder_, {{"array-job", array + "\n"}});
    report(fmt::format("Slurm job array {} with {}; logs in {}", array,
                       counted(static_cast<std::size_t>(tasks), "task"), folder_.string()));
    submit_merge({array});
  }

 private:
  [[nodiscard]] bool stopped() const { return options_.stop_requested && options_.stop_requested(); }
  void report(const std::string& step) const {
    if (options_.on_step) options_.on_step(step);
  }

  /// Submits a job. @return its id
  [[nodiscard]] std::string submit(std::vector<std::string> options,
                                   const std::vector<std::string>& command) const {
    options.insert(options.begin(), "--parsable");
    options.insert(options.end(), command.begin(), command.end());
    const std::string output =
        require_tool({.program = "sbatch", .arguments = options, .stop_requested = options_.stop_requested});
    std::string id = output.substr(0, output.find_first_of(";\n"));  // "ID" or "ID;CLUSTER"
    if (id.empty() || !std::ranges::all_of(id, [](unsigned char c) { return std::isdigit(c) != 0; }))
      throw InputError("sbatch", "printed no job id: " + output);
    return id;
  }

  /// Submits the job that merges the stores after all `jobs` ended, and waits for it. The caller merges as
  /// well and notices if the job did not.
  void submit_merge(const std::vector<std::string>& jobs) const {
    const std::vector<std::string> arguments = {"--parsable",
                                                "--wait",
                                                "--job-name=stillpoint-merge",
                                                "--output=" + (folder_ / "merge.log").string(),
                                                fmt::format("--dependency=afterany:{}", fmt::join(jobs, ":")),
                                                folder_ / "merge.sh",
                                                executable_path(),
                                                folder_ / "job",
                                                fs::absolute(options_.store)};
    static_cast<void>(
        call_tool({.program = "sbatch", .arguments = arguments, .stop_requested = options_.stop_requested}));
    if (stopped()) report("the Slurm jobs continue; the same command waits for them, scancel ends them");
  }

  /// The array job of an earlier call, if it has not ended.
  [[nodiscard]] std::vector<std::string> active_jobs() const {
    const fs::path file = folder_ / "array-job";
    if (!fs::exists(file)) return {};
    std::string id = eval::read_text_file(file);
    while (id.ends_with('\n')) id.pop_back();
    // squeue fails for jobs that Slurm has forgotten; they have ended.
    const ToolResult queue =
        call_tool({.program = "squeue", .arguments = {"--noheader", "--format=%F", "--jobs=" + id}});
    std::istringstream rows(queue.output);
    std::set<std::string> active;
    for (std::string row; rows >> row;) active.insert(row);
    return queue.exit_code == 0 ? std::vector<std::string>(active.begin(), active.end())
                                : std::vector<std::string>{};
  }

  DistributionOptions options_;
  RunKind kind_;
  fs::path folder_;
};

}  // namespace

Executor slurm_executor(const PlanMatrix& matrix, const DistributionOptions& options) {
  const auto jobs = std::make_shared<const SlurmJobs>(matrix, options);
  return {.collect = [jobs] { jobs->collect(); },
          .execute = [jobs](int tasks) { jobs->execute(tasks); },
          .system_files = SystemFiles::kShared};
}

}  // namespace stillpoint::bench
