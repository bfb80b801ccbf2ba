// One ray at a sphere, with the small libraries alone: the consumer builds them itself.
#include <base/checksum.h>
#include <base/input_file.h>
#include <trace/sdf_intersector.h>

#include <cstdio>

int main(int, char** argv) {
    const stratum::InputFile file(argv[1]);
    const auto scene = stratum::trace::makeSdfIntersector(stratum::trace::sdfSphere({0, 0, 0}, 2.0));
    stratum::trace::Ray ray;
    ray.origin = {0, 0, -5};
    stratum::trace::Hit hit;
    const bool met = scene->makeTracer()->intersect(ray, hit);
    std::printf("%d %.3f %s\n", met, hit.t, stratum::sha256Hex(file.bytes()).c_str());
}
