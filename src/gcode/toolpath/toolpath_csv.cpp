#include "gcode/toolpath/toolpath_csv.h"

#include "base/atomic_file.h"

#include <fmt/format.h>

#include <iterator>

namespace stratum::gcode {

void writeToolpathCsv(const Toolpath& toolpath, const std::filesystem::path& path) {
    FileWriter out(path);
    out.text(
        "line,layer,feature,tool,object,x0,y0,z0,x1,y1,z1,center_x,center_y,sweep,width,height,length,volume,speed\n");
    fmt::memory_buffer text;
    for (const Bead& bead : toolpath.beads) {
        const Run& run = toolpath.runOf(bead);
        const double length = beadLength(toolpath, bead);
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{},", toolpath.lineOf(bead), run.layer,
                       featureName(run.feature), run.tool, run.object, double{bead.x0}, double{bead.y0},
                       double{bead.z0}, double{bead.x1}, double{bead.y1}, double{bead.z1});
        if (bead.arc >= 0) {
            const Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
            fmt::format_to(std::back_inserter(text), "{},{},{},", arc.center_x, arc.center_y, arc.sweep);
        } else {
            fmt::format_to(std::back_inserter(text), ",,,");
        }
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", bead.width, run.height, length,
                       laidVolume(toolpath, static_cast<std::uint32_t>(&bead - toolpath.beads.data())), run.speed);
        out.text({text.data(), text.size()});
        text.clear();
    }
    out.commit();
}

}  // namespace stratum::gcode
