// Embree 3 or 4, whichever is installed: the two name a query's arguments differently.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace stratum::bench {

// Single rays and shadow rays are incoherent, which is Embree's default; packets of nearest hits are coherent.

#if RTC_VERSION_MAJOR >= 4

inline void intersectOne(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, nullptr); }

inline void intersectPacket(RTCScene scene, const int* valid, RTCRayHit16& packet) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &packet, &arguments);
}

inline void occludedOne(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }

inline void occludedPacket(RTCScene scene, const int* valid, RTCRay16& packet) {
    rtcOccluded16(valid, scene, &packet, nullptr);
}

#else

inline RTCIntersectContext contextOf(RTCIntersectContextFlags flags) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    return context;
}

inline void intersectOne(RTCScene scene, RTCRayHit& ray) {
    RTCIntersectContext context = contextOf(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    rtcIntersect1(scene, &context, &ray);
}

inline void intersectPacket(RTCScene scene, const int* valid, RTCRayHit16& packet) {
    RTCIntersectContext context = contextOf(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
    rtcIntersect16(valid, scene, &context, &packet);
}

inline void occludedOne(RTCScene scene, RTCRay& ray) {
    RTCIntersectContext context = contextOf(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    rtcOccluded1(scene, &context, &ray);
}

inline void occludedPacket(RTCScene scene, const int* valid, RTCRay16& packet) {
    RTCIntersectContext context = contextOf(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    rtcOccluded16(valid, scene, &context, &packet);
}

#endif

}  // namespace stratum::bench
