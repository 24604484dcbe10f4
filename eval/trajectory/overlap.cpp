// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/overlap.h"

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {
namespace {

std::string span_text(Timestamp first, Timestamp last) {
  return format_stamp(first) + " to " + format_stamp(last) + " s";
}

}  // namespace

void require_overlap(const Trajectory& gt, const Trajectory& est, double offset_s, const std::string& place) {
  const Timestamp gt_first = gt.poses.front().t;
  const Timestamp gt_last = gt.poses.back().t;
  const Timestamp est_first = after(est.poses.front().t, offset_s);
  const Timestamp est_last = after(est.poses.back().t, offset_s);
  if (est_first <= gt_last && gt_first <= est_last) return;
  throw InputError(place, "covers " + span_text(est_first, est_last) + ", the ground truth " +
                              span_text(gt_first, gt_last) +
                              ": no overlap in time; are both of the same recording, and their stamps of the "
                              "same clock (--offset)?");
}

}  // namespace stillpoint::eval
