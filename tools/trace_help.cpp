#include "trace_help.h"

namespace stratum::tools {

const char* const kTraceExamples = R"(
Examples:
  vdbtrace part.vdb                           part.png in studio light
  vdbtrace part.gcode                         the same without a .vdb
  vdbtrace part.gcode --printed 50% --voxel-size 0.05
  vdbtrace part.gcode --film part.mp4 --nozzle      the print as it grows, 8 s
  vdbtrace part.vdb -o part.png --view front --spp 64
  vdbtrace part.vdb -o part.exr --integrator ao     linear values, for compositing and measuring
  vdbtrace part.vdb --brdf plastic:0.8,0.1,0.05,0.2 --env constant:1,1,1
  vdbtrace part.vdb --eye 120,-200,90 --look-at 0,0,20 --fov 25)";

Brief traceBrief() {
    return {{"IN", "A print, a level set, or a scene (.json)"},
            {"--output", ".png, .jpg, .webp or a linear .exr"},
            {"--size", ""},
            {"--spp", "Samples a pixel (default 8, denoised)"},
            {"--noise", "Samples until the error is this, e.g. 0.05"},
            {"--denoise", "The default for all but .exr"},
            {"--view", "iso, front, back, left, right, top, bottom"},
            {"--eye", "Where the camera stands"},
            {"--look-at", "What it looks at (default: the part)"},
            {"--turntable", "N pictures from all around"},
            {"--integrator", "path, direct, phong, ao, normal, depth, ..."},
            {"--color", "'#ff6600', teal, 'Prusament Galaxy Black'"},
            {"--brdf", "plastic:R,G,B,ALPHA, pla-blue, a table, ..."},
            {"--color-by", "tool, feature, layer, speed, width, ..."},
            {"--env", "studio, sky, constant:R,G,B, .hdr or .exr"},
            {"--bed", "A bed under the print (the default)"},
            {"--voxel-size", "Of G-code"},
            {"--printer", "ideal, typical, or your printer's limits"},
            {"--printed", "A part of the print: 50%, layer:40"},
            {"--film", "The print as it grows: .mp4, .webm, .gif"},
            {"--threads", ""},
            {"--stats", "Write a JSON report; - is standard output"},
            {"--quiet", ""},
            {"--version", "How it was built, and with what"},
            {"--help", ""},
            {"--help-all", ""}};
}

}  // namespace stratum::tools
