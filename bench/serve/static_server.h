// SPDX-License-Identifier: BSD-3-Clause
/// Files in memory for a browser on this machine. There is no way from a request to the disk.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/record/output_folder.h"

struct MHD_Daemon;

namespace stillpoint {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< IPv4; this one is reached from this machine alone
  int port = 8035;                    ///< 0: any that is free
};

/// Answers GET and HEAD until it is destroyed, in one thread of its own. At most 32 connections of 32 kB
/// each, which are closed after 10 s without a word; longer requests are refused. On a loopback address only
/// requests that name this machine as their host are answered, so that no other site's page can read along.
class StaticServer {
 public:
  /// @param files by their paths, "index.html" stands for the folder it is in
  /// @throws InputError if the address is none, or cannot be taken
  StaticServer(const std::vector<OutputFile>& files, const ServerOptions& options);

  StaticServer(const StaticServer&) = delete;  // its thread knows where it is
  StaticServer& operator=(const StaticServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;

  /// What a request is answered with.
  struct Answer {
    unsigned status = 200;
    const std::string* text = nullptr;  ///< lives as long as the server
    std::string type;                   ///< of its content
  };
  /// @param path as requested, without escapes
  /// @param host as the request names it, empty if it does not
  [[nodiscard]] Answer answer(const std::string& method, const std::string& path,
                              const std::string& host) const;

 private:
  std::map<std::string, std::string> texts_;  ///< by path, "/index.html"
  std::map<unsigned, std::string> refusals_;  ///< texts by status
  std::string address_;
  std::unique_ptr<MHD_Daemon, void (*)(MHD_Daemon*)> daemon_;
};

}  // namespace stillpoint
