// The objects of a scene file: what stands where, and of what it is made.
#pragma once

#include "base/options/json_section.h"
#include "shade/scene/material.h"
#include "trace/scene_intersector.h"
#include "trace/sdf.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace stratum::assemble {

/// One object as the file describes it. Either `vdb` or `sdf` is set.
struct ObjectOptions {
    std::string vdb;          ///< path of a level set's file
    std::string grid{};       ///< empty: chosen as by --grid
    trace::SdfPtr sdf{};      ///< a shape by formula, in its own space
    std::string up{};         ///< axis of the file that points up: "y", "z", or empty for what the file says
    double voxel_size = 0.0;  ///< of an sdf that is voxelized; 0: traced as it is
    double tolerance = 1e-4;  ///< of an sdf that is traced as it is, see makeSdfIntersector()
    trace::Placement placement{};
    shade::MaterialOptions material{};  ///< empty: the scene's
};

/// Reads one entry of "objects". Throws InputError with the path of what is wrong.
ObjectOptions readObject(JsonSection section, const std::filesystem::path& folder);

/// What file_up takes.
inline constexpr Names<std::string_view, 2> kUps = {{{"z", "z"}, {"y", "y"}}};

/// "color_range": values at the ends of the ramp of `color_by`, ascending; nothing if it is not there.
std::optional<std::array<double, 2>> readColorRange(OptionSource& options, const std::string& color_by);

/// A file beside the scene, if there is one of that name; else the text as it is: a preset.
std::string beside(const std::filesystem::path& folder, const std::string& text);

/// A material's text in a scene: that of a preset as it is, else a file beside the scene, if there is one.
std::string materialBeside(const std::filesystem::path& folder, const std::string& text);

}  // namespace stratum::assemble
