#include "study/print.h"

#include "base/checksum.h"
#include "base/input_file.h"
#include "gcode/container/container.h"
#include "gcode/reader.h"
#include "voxelize/beads/bead_field.h"

namespace stratum::study {

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

voxelize::Lattice latticeOf(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads,
                            int voxels_per_layer) {
    voxelize::LatticeRequest request;
    request.voxels_per_layer = voxels_per_layer;
    return voxelize::chooseLattice(toolpath, beads, voxelize::boundsOf(toolpath, beads), request);
}

std::string shortHash(const std::string& path) { return sha256Hex(InputFile(path).bytes()).substr(0, 12); }

}  // namespace stratum::study
