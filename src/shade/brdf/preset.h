// Parses options like `plastic:0.8,0.2,0.1,0.25`: a name and numbers.
#pragma once

#include "shade/color.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

struct Preset {
    std::string name;
    std::vector<float> values;
};

/// Splits `name` or `name:number,number,...`. The numbers must be finite floats.
/// @param option  its name for messages, e.g. "--brdf"
/// Throws UsageError.
Preset parsePreset(std::string_view text, std::string_view option);

/// Throws UsageError unless there are as many values as `form` says, e.g. "lambert:R,G,B".
void requireValues(const Preset& preset, std::size_t count, std::string_view option, std::string_view form);

/// Throws UsageError unless values[index] is in [low, high].
void requireRange(const Preset& preset, std::size_t index, float low, float high, std::string_view option,
                  std::string_view what);

/// The first three values, R,G,B. Throws UsageError unless each is a reflectance, in [0, 1].
Color bodyColor(const Preset& preset, std::string_view option);

}  // namespace stratum::shade
