// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/transform_graph.h"

#include <deque>
#include <map>

namespace stillpoint::datasets {

std::optional<Pose> find_transform(std::span<const NamedTransform> links, const std::string& a,
                                   const std::string& b) {
  std::map<std::string, Pose> T_a_known{{a, Pose{}}};
  std::deque<std::string> frontier{a};
  while (!frontier.empty() && !T_a_known.contains(b)) {
    const std::string frame = frontier.front();
    frontier.pop_front();
    const Pose T_a_frame = T_a_known.at(frame);
    const auto visit = [&](const std::string& next, const Pose& T_frame_next) {
      // The product with the identity would change the last bits of a single link.
      if (T_a_known.emplace(next, frame == a ? T_frame_next : T_a_frame * T_frame_next).second)
        frontier.push_back(next);
    };
    for (const NamedTransform& link : links) {
      if (link.parent == frame) visit(link.child, link.T_parent_child);
      if (link.child == frame) visit(link.parent, link.T_parent_child.inverse());
    }
  }
  const auto found = T_a_known.find(b);
  if (found == T_a_known.end()) return std::nullopt;
  return found->second;
}

}  // namespace stillpoint::datasets
