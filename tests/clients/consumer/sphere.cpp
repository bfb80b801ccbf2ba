// One ray at a sphere, with the small libraries alone: the consumer builds them itself.
#include <io/mapped_file.h>
#include <march/sdf_intersector.h>

#include <cstdio>

int main(int, char** argv) {
    const stratum::MappedFile file(argv[1]);
    const auto scene = stratum::march::makeSdfIntersector(stratum::march::sdfSphere({0, 0, 0}, 2.0));
    stratum::march::Ray ray;
    ray.origin = {0, 0, -5};
    stratum::march::Hit hit;
    const bool met = scene->makeTracer()->intersect(ray, hit);
    std::printf("%d %.3f %s\n", met, hit.t, stratum::sha256Hex(file.bytes()).c_str());
}
