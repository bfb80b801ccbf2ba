// The pictures of one vdbtrace camera, each from a ready scene to its file and its report: of one input, of several
// that make a series, of a print that grows.
#pragma once

#include "batch.h"
#include "trace_options.h"

#include "assemble/ready_scene.h"
#include "assemble/traced_objects.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace stratum::tools {

/// The picture's name with a number, if there are several.
std::string numbered(const std::string& output, std::size_t number, std::size_t count);

/// A picture of a scene, finished but not written.
struct Rendered {
    shade::RenderResult result;  ///< denoised, of the crop without the margin that the denoiser needed
    double render_seconds = 0.0, denoise_seconds = 0.0;
};

/// Draws what stands before a finished picture.
using DrawOver = std::function<void(shade::Film&)>;

/// Renders a picture as the command says, and denoises it, unless it is a piece for a merge. Throws what render()
/// throws.
/// @param progress  of rendering: fractions
Rendered renderPicture(const TraceCommand& command, const trace::Intersector& print,
                       const shade::SceneDescription& scene, const std::function<void(double)>& rendering,
                       const std::function<void(double)>& denoising, const DrawOver& over);

/// The value of a white surface in the film of a picture.
double whiteOf(const TraceCommand& command);

/// How much of it, for --stats.
nlohmann::ordered_json raysReport(const shade::RayCounts& rays);

struct Frame {
    std::string source;
    std::size_t number = 0;  ///< of the command's pictures, from 0
    double load_seconds = 0.0, build_seconds = 0.0;
    DrawOver over;  ///< may be empty
};

/// Renders and writes it. Returns its report. Throws OutputError and what render() throws.
nlohmann::ordered_json renderFrame(const TraceCommand& command, const Frame& frame,
                                   const assemble::TracedObjects& objects, const shade::SceneDescription& scene,
                                   int threads);

/// How the command's files are read, and made ready for rays; what a pixel spans is left to the caller. Throws
/// UsageError.
assemble::TracingOptions readingOf(const TraceCommand& command);

/// What is read for input n: it alone, or the objects of the scene.
std::vector<assemble::ObjectOptions> objectsOf(const TraceCommand& command, std::size_t n);

/// What the scene around them depends on.
assemble::StageOptions stageOptionsOf(const TraceCommand& command);

/// Renders and writes all pictures of `command`, whose options are checked. Inputs that fail are the batch's; the
/// camera is of the last one that doesn't. Returns the pictures' reports.
nlohmann::ordered_json traceSeries(const TraceCommand& command, int threads, Batch& batch);

}  // namespace stratum::tools
