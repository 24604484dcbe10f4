// SPDX-License-Identifier: BSD-3-Clause
/// A server with the archives of small datasets, a catalogue that names it, and an empty folder of downloads.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/fault_server.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_archive.h"

namespace stillpoint {

class DatasetHost {
 public:
  /// Changes the response to a request; for defects.
  using Defect = std::function<ServedResponse(const ServedRequest&, ServedResponse)>;

  explicit DatasetHost(Defect defect = {});

  /// Writes an archive that the server offers as /DATASET/FILE.
  void offer(const std::string& file, const std::vector<TestEntry>& entries) const;

  /// Writes the catalogue file of a dataset.
  /// @param sequences the text of its [[sequences]] and [archives] tables
  void add_dataset(const std::string& name, const std::string& sequences) const;

  /// `stillpoint data get` with the accepted licence and short waits.
  [[nodiscard]] ProgramResult get(const std::vector<std::string>& arguments,
                                  ProgramOptions options = {}) const;

  /// Executes the program with the folders of this host.
  [[nodiscard]] ProgramResult run(const std::vector<std::string>& arguments,
                                  ProgramOptions options = {}) const;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  [[nodiscard]] std::filesystem::path data() const { return folder_.path() / "data"; }
  [[nodiscard]] int requests() const { return server_.requests(); }
  [[nodiscard]] std::string url(const std::string& path) const { return server_.url(path); }
  /// Number of registered sequences.
  [[nodiscard]] std::size_t registered() const;

 private:
  TemporaryFolder folder_;
  FaultServer server_;
};

/// The files of a sequence as written by a function of sequence_folders.h, below a folder of an archive.
[[nodiscard]] std::vector<TestEntry> sequence_entries(void (*write)(const TemporaryFolder&),
                                                      const std::string& prefix);

/// The bytes of an archive, to be put into another one.
[[nodiscard]] std::string archive_bytes(const std::string& name, const std::vector<TestEntry>& entries);

}  // namespace stillpoint
