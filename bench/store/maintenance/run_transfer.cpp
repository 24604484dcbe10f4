// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/run_transfer.h"

namespace stillpoint::bench {

bool add_run(StoreWriter& writer, const RunIdentity& identity, const RunOutcome& outcome) {
  if (writer.acquire(identity) != RunLease::kGranted) return false;
  writer.finish(identity, outcome);
  return true;
}

}  // namespace stillpoint::bench
