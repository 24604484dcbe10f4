// SPDX-License-Identifier: BSD-3-Clause
/// One attempt to transfer the content of an address to a partial file.
#pragma once

#include <cstdint>
#include <string>

#include "datasets/download/partial_file.h"
#include "datasets/download/transfer_control.h"

namespace stillpoint::datasets {

/// Proxies are those of the environment (http_proxy, https_proxy, all_proxy, no_proxy).
struct TransferSettings {
  std::string user_agent;  ///< empty: the name of this program
  std::string token;       ///< sent as `Authorization: Bearer`, to the first host only; empty = none
  int connect_timeout_s = 30;
  int stall_timeout_s = 30;  ///< a transfer below 1 kB/s for this time is ended
  int max_redirects = 10;
};

/// What is transferred.
struct TransferSource {
  std::string url;
  std::uint64_t expected_bytes = 0;  ///< content of another size is rejected; 0 = any
};

enum class TransferOutcome {
  kComplete,
  kStopped,    ///< by `TransferControl::stop`; the next attempt continues
  kTemporary,  ///< another attempt may succeed
  kPermanent,  ///< the address does not provide the file
};

struct TransferResult {
  TransferOutcome outcome = TransferOutcome::kPermanent;
  std::string problem;         ///< for messages; empty if complete or stopped
  double retry_after_s = 0.0;  ///< requested by the server
};

/// Continues at the end of the partial file if the server confirms by status 206, Content-Range, ETag,
/// Last-Modified and size that the content is the same; begins again otherwise.
/// @throws InputError if the disk is full, before the transfer where the size is known
[[nodiscard]] TransferResult transfer(const TransferSource& source, PartialFile& part,
                                      const TransferSettings& settings, const TransferControl& control);

}  // namespace stillpoint::datasets
