// The parameters of functions and their defaults, as inspect.signature() and help() tell them.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace stratum::python {

/// Those of readOptionsOf().
inline constexpr std::string_view kReadParameters =
    "plate=None, filament_diameter=None, filament_colors=None, tool_offsets=None, layer_height=None, belt=None, "
    "planar=None, "
    "e_mode=None, firmware=None, planner=None, printer=None, beads=None, section=None, flow=None, "
    "flow_lag=None, pressure_advance=None, sag=None, crown=None, strings=None";
/// Those of printOptionsOf().
inline constexpr std::string_view kPrintParameters =
    "voxel_size=None, voxels_per_layer=None, tolerance=None, memory_budget=None, half_width=None, "
    "layers=None, features=None, objects=None, tools=None";
/// Those of readSelection().
inline constexpr std::string_view kSelectionParameters = "layers=None, features=None, objects=None, tools=None";
/// What levelSetChoicesOf() reads besides.
inline constexpr std::string_view kLevelSetParameters =
    "interior=None, interior_distance=None, grids=None, unit=None, up=None, origin=None";
/// How a .vdb is written.
inline constexpr std::string_view kFileParameters = "precision=None, compression=None, overwrite=None";
/// What renderCallOf() reads besides those of prints.
inline constexpr std::string_view kPictureParameters =
    "size=None, spp=None, noise=None, seconds=None, seed=None, crop=None, aov=None, denoise=None, "
    "exposure=None, legend=None, view=None, eye=None, look_at=None, up=None, fov=None, f_number=None, "
    "aperture=None, focus=None, frame=None, zoom=None, integrator=None, bounces=None, exact_translucency=None, "
    "phong=None, ao_distance=None, brdf=None, color=None, color_by=None, color_range=None, normals=None, env=None, "
    "env_rotation=None, env_exposure=None, lights=None, bed=None, bed_surface=None, background=None, "
    "march=None, brick_values=None, brick_cache=None, clip=None, grid=None, file_up=None, printed=None";

/// A docstring that begins with what Python takes for its __text_signature__.
/// @param call  "name(parameters)", of which Python sees the first
inline std::string documented(std::string_view call, std::string_view text) {
    return fmt::format("{}\n--\n\n{}", call, text);
}

}  // namespace stratum::python
