// Preset names. They have priority over files of the same name; such a file is given as ./NAME.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// Whether the text of --env names a light that needs no file: studio, sky, constant, alone or with numbers.
bool isEnvironmentPreset(std::string_view text);

/// Whether the text of --brdf names a material of the project: a formula with its numbers, or a table in data/brdf.
bool isBrdfPreset(std::string_view text);

/// A material by a formula: how --brdf has it, e.g. "fdm:R,G,B,ALPHA[,RATIO]", and what it is where its name does not
/// say so.
struct BrdfForm {
    std::string_view form, meaning;
};
std::vector<BrdfForm> brdfForms();

/// The materials of the project that have a name, sorted: tables, e.g. "pla-blue", and translucent ones.
std::vector<std::string> brdfNames();

}  // namespace stratum::shade
