// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/run_rows.h"

#include "core/base/error.h"

namespace stillpoint::bench {

StoredRun run_of(const Statement& row) {
  StoredRun run;
  run.id = row.integer(0);
  run.key = row.text(1);
  run.identity = {.system = row.text(2),
                  .variant = row.text(3),
                  .sequence = row.text(4),
                  .sequence_id = row.text(5),
                  .config_hash = row.text(6),
                  .build = row.text(7),
                  .mode = row.text(8),
                  .kind = row.text(9),
                  .cores = row.text(10),
                  .seed = row.integer(11),
                  .repetition = row.integer(12),
                  .axis = row.text(13),
                  .axis_value = row.real(14)};
  run.outcome = outcome_of(row.text(15));
  run.detail = escaped_utf8(row.text(16));
  run.started = row.text(17);
  run.ended = row.text(18);
  run.manifest_hash = row.text(19);
  return run;
}

Metric metric_of(const Statement& row) { return {row.text(1), row.text(2), row.text(3), row.real(4)}; }

ModuleCost cost_of(const Statement& row) {
  return {row.text(1), row.text(2), row.integer(3), row.real(4), row.real(5), row.real(6), row.real(7)};
}

}  // namespace stillpoint::bench
