// SPDX-License-Identifier: BSD-3-Clause
/// The queries of Embree 3 (Debian 12) and Embree 4 (Debian 13), whose arguments differ.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace stillpoint::synth {

/// First hits of eight rays with similar directions.
/// @param valid -1 for rays to trace, else 0
inline void intersect_similar_rays(const int* valid, RTCScene scene, RTCRayHit8& hits) {
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &hits, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &context, &hits);
#endif
}

/// Sets `ray.tfar` to -infinity if anything is hit.
inline void find_occlusion(RTCScene scene, RTCRay& ray) {
#if RTC_VERSION_MAJOR >= 4
  rtcOccluded1(scene, &ray, nullptr);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
#endif
}

}  // namespace stillpoint::synth
