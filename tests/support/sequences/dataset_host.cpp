// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/sequences/dataset_host.h"

#include <fstream>
#include <iterator>

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream input(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(input), {}};
}

ServedResponse offered_file(const fs::path& folder, const ServedRequest& request) {
  const fs::path file = folder / request.path.substr(1);
  if (!fs::is_regular_file(file)) return {.status = 404, .headers = {}, .body = "no such file"};
  const std::string content = bytes_of(file);
  return file_response(request, content, "\"" + std::to_string(content.size()) + "\"");
}

}  // namespace

DatasetHost::DatasetHost(Defect defect)
    : server_([this, defect](const ServedRequest& request) {
        ServedResponse response = offered_file(folder_.path() / "host", request);
        return defect ? defect(request, std::move(response)) : response;
      }) {
  fs::create_directories(data());
}

void DatasetHost::offer(const std::string& file, const std::vector<TestEntry>& entries) const {
  write_archive(folder_.path() / "host" / file, entries);
}

void DatasetHost::add_dataset(const std::string& name, const std::string& sequences) const {
  folder_.write("catalogue/" + name + ".toml",
                "name = \"" + name +
                    "\"\ntitle = \"Test\"\nlicence = \"free\"\nlayout = \"tum\"\n"
                    "urls = [\"" +
                    url("/" + name + "/{}") + "\"]\n" + sequences);
}

ProgramResult DatasetHost::get(const std::vector<std::string>& arguments, ProgramOptions options) const {
  std::vector<std::string> words{"data", "get"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  for (const char* word :
       {"--accept-licence", "--backoff", "0.01", "--attempts", "3", "--stall-timeout", "20"})
    words.emplace_back(word);
  return run(words, std::move(options));
}

ProgramResult DatasetHost::run(const std::vector<std::string>& arguments, ProgramOptions options) const {
  for (const std::string& setting :
       {"STILLPOINT_DATA=" + data().string(), "STILLPOINT_REGISTRY=" + (path() / "registry.json").string(),
        "STILLPOINT_CATALOGUE=" + (path() / "catalogue").string()})
    options.environment.push_back(setting);
  return run_program(arguments, options);
}

std::size_t DatasetHost::registered() const {
  const std::string text = bytes_of(path() / "registry.json");
  std::size_t count = 0;
  for (std::size_t at = text.find("\"checksum\""); at != std::string::npos;
       at = text.find("\"checksum\"", at + 1))
    ++count;
  return count;
}

std::vector<TestEntry> sequence_entries(void (*write)(const TemporaryFolder&), const std::string& prefix) {
  const TemporaryFolder folder;
  write(folder);
  return folder_entries(folder.path(), prefix);
}

std::string archive_bytes(const std::string& name, const std::vector<TestEntry>& entries) {
  const TemporaryFolder folder;
  write_archive(folder.path() / name, entries);
  return bytes_of(folder.path() / name);
}

}  // namespace stillpoint
