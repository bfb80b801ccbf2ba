// A small print as the viewer's input.
#pragma once

#include "corpus.h"
#include "view/asked/picture_plan.h"

namespace stratum::test {

inline view::GivenInput givenTile(double voxel_size) {
    view::GivenInput given;
    given.path = (sourceDir() / "data/gcode/tile.gcode").string();
    given.objects.push_back({.vdb = given.path});
    given.options.tracing.prints.print.lattice.voxel_size = voxel_size;
    return given;
}

}  // namespace stratum::test
