// All that a page chooses of a view, and its JSON.
#pragma once

#include "shade/camera/camera.h"
#include "shade/scene/bed.h"
#include "trace/clip_intersector.h"

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stratum::view {

/// The text of a choice that the page leaves to what the viewer was started with.
inline constexpr const char* kAsGiven = "";

/// Lengths are in world units, as those of vdbtrace's options. Every state that parseViewState() returns makes options
/// that name no file.
struct ViewState {
    int width = 1280, height = 720;  ///< pixels of the finished picture

    std::optional<shade::View> named;  ///< a view that is fitted; else `eye`
    std::optional<glm::dvec3> eye;     ///< both empty: as given
    glm::dvec3 look_at{0.0};
    std::optional<glm::dvec3> up;
    double fov = 28.0;  ///< degrees

    std::uint32_t first_layer = 0, last_layer = 0;  ///< 0: as given
    std::optional<double> printed;                  ///< per cent; empty: all
    std::optional<std::uint32_t> beads;             ///< that are printed, instead of a share; empty: all
    bool by_time = false;                           ///< of the time; else of the volume
    std::vector<std::string> hidden_features;       ///< names
    std::vector<std::uint32_t> objects;             ///< numbers; empty: all
    std::vector<std::uint8_t> tools;                ///< T numbers; empty: all

    std::string color_by;                              ///< an attribute; kAsGiven
    std::optional<std::array<double, 2>> color_range;  ///< values at the ends of its ramp
    std::string material;                              ///< text of --brdf that needs no file of the user's; kAsGiven
    std::string light;                                 ///< text of --env that needs no file; kAsGiven
    double light_rotation = 0.0;                       ///< degrees
    std::optional<double> exposure;                    ///< stops
    std::optional<bool> bed;                           ///< empty: as given
    std::optional<shade::BedSurface> bed_surface;
    bool smooth = false;  ///< smooth normals
    std::optional<trace::ClipPlane> clip;
    std::string integrator;  ///< kAsGiven
    int spp = 0;             ///< samples a pixel; 0: as vdbtrace chooses

    bool operator==(const ViewState& other) const;
};

/// Reads what a page sends. Throws InputError for all that is no such state: unknown keys and names, numbers that are
/// not finite or out of range, texts that would name a file.
ViewState parseViewState(const nlohmann::json& json);

/// The inverse.
nlohmann::json toJson(const ViewState& state);

}  // namespace stratum::view
