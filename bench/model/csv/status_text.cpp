// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/csv/status_text.h"

#include <fmt/format.h>

#include "bench/model/csv/csv_rows.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kStatusHeader = "frame,t_ns,status,segment,x,y,z,qx,qy,qz,qw,sigma_m,sigma_rad";

FrameClaim claim_of(const CsvRows& rows, std::string_view text) {
  FrameClaim claim;
  claim.frame = rows.number(cut_front(text, ','));
  claim.t_ns = rows.number(cut_front(text, ','));
  claim.status = std::string(cut_front(text, ','));
  claim.segment = static_cast<int>(rows.number(cut_front(text, ',')));
  for (int i = 0; i < kPoseColumns; ++i) cut_front(text, ',');
  claim.sigma_m = rows.real(cut_front(text, ','));
  claim.sigma_rad = rows.real(text);
  return claim;
}

}  // namespace

std::string claim_text(std::span<const FrameClaim> claims) {
  std::string text = std::string(kStatusHeader) + "\n";
  for (const FrameClaim& claim : claims) {
    const Pose& T = claim.T_w_c;
    text += fmt::format("{},{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.6g},{:.6g}\n",
                        claim.frame, claim.t_ns, claim.status, claim.segment, T.p.x(), T.p.y(), T.p.z(),
                        T.q.x(), T.q.y(), T.q.z(), T.q.w(), claim.sigma_m, claim.sigma_rad);
  }
  return text;
}

std::vector<FrameClaim> parse_claims(std::string_view text, const std::string& place) {
  std::vector<FrameClaim> claims;
  CsvRows rows{.place = place, .header = kStatusHeader};
  rows.for_each_row(text, [&](std::string_view row) { claims.push_back(claim_of(rows, row)); });
  return claims;
}

}  // namespace stillpoint::bench
