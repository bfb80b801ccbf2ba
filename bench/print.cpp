#include "print.h"

#include "gcode/input_bytes.h"
#include "gcode/reader.h"
#include "voxelize/selection.h"

#include <chrono>
#include <ctime>

namespace stratum::bench {

gcode::Toolpath readPrint(const std::string& path) {
    const gcode::InputBytes file(path);
    return gcode::readToolpath(file.bytes(), file.name());
}

voxelize::Lattice latticeOf(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                            double voxel_size) {
    voxelize::LatticeRequest request;
    request.voxel_size = voxel_size;
    return voxelize::chooseLattice(toolpath, beads, voxelize::boundsOf(toolpath, beads), request);
}

Times timesOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    work();
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC};
}

}  // namespace stratum::bench
