// Embree 3 or 4, whichever is installed: the two name a query's arguments differently.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cstdint>

namespace stratum::bench {

/// What is expected of the rays of a packet. Single rays are always incoherent.
enum class Rays : std::uint8_t { incoherent, coherent };

#if RTC_VERSION_MAJOR >= 4

inline RTCIntersectArguments intersectArguments(Rays rays) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = rays == Rays::coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    return arguments;
}

inline void intersectOne(RTCScene scene, RTCRayHit& ray) {
    RTCIntersectArguments arguments = intersectArguments(Rays::incoherent);
    rtcIntersect1(scene, &ray, &arguments);
}

inline void intersectPacket(RTCScene scene, Rays rays, const int* valid, RTCRayHit16& packet) {
    RTCIntersectArguments arguments = intersectArguments(rays);
    rtcIntersect16(valid, scene, &packet, &arguments);
}

inline void occludedOne(RTCScene scene, RTCRay& ray) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    rtcOccluded1(scene, &ray, &arguments);
}

inline void occludedPacket(RTCScene scene, const int* valid, RTCRay16& packet) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    rtcOccluded16(valid, scene, &packet, &arguments);
}

#else

inline RTCIntersectContext contextOf(Rays rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        rays == Rays::coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

inline void intersectOne(RTCScene scene, RTCRayHit& ray) {
    RTCIntersectContext context = contextOf(Rays::incoherent);
    rtcIntersect1(scene, &context, &ray);
}

inline void intersectPacket(RTCScene scene, Rays rays, const int* valid, RTCRayHit16& packet) {
    RTCIntersectContext context = contextOf(rays);
    rtcIntersect16(valid, scene, &context, &packet);
}

inline void occludedOne(RTCScene scene, RTCRay& ray) {
    RTCIntersectContext context = contextOf(Rays::incoherent);
    rtcOccluded1(scene, &context, &ray);
}

inline void occludedPacket(RTCScene scene, const int* valid, RTCRay16& packet) {
    RTCIntersectContext context = contextOf(Rays::incoherent);
    rtcOccluded16(valid, scene, &context, &packet);
}

#endif

}  // namespace stratum::bench
