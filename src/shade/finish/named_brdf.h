// Materials by their text: a formula with its numbers, a table of the project, a file or a color.
#pragma once

#include "shade/brdf/brdf.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// The default material: satin orange PLA.
extern const char* const kDefaultBrdf;

/// A material from the text of --brdf. R, G, B are linear reflectances in [0, 1].
///   lambert:R,G,B        ideal diffuse
///   plastic:R,G,B,ALPHA  diffuse under a dielectric coat, ALPHA is GGX's alpha in [0.001, 1] (not "roughness")
///   translucent:...      light goes through it, see makeTranslucent in translucent.h, which has the names of some
///   td:R,G,B,MM          the same by its transmission distance
///   metal:R,G,B,ALPHA    a conductor; R, G, B is what it reflects straight back
///   matte:R,G,B          rough and diffuse, without a coat: finishes.h
///   fdm:R,G,B,ALPHA[,RATIO]  plastic whose gloss has the direction of printed lines: alpha is ALPHA on the mean, and
///                        RATIO times as large across the line as along it (default kLineRatio)
///   silk:R,G,B           plastic with pearlescent platelets: finishes.h
///   glitter:R,G,B[,MM]   plastic with flakes of that size: glitter.h
///   FILE, or NAME        a measured table, see readBrdfFile; of a NAME, e.g. pla-blue, that of data/brdf,
///                        looked for in $STRATUM_DATA/brdf, or where it was installed or built
///   COLOR                "#ff6600" or a color's name: plastic of that color, see filament_color.h; nothing:
///                        kDefaultBrdf
/// Throws UsageError, InputError.
std::shared_ptr<const Brdf> makeBrdf(std::string_view text);

/// Whether the text of --brdf names a material of the project: a formula with its numbers, or a table in data/brdf.
/// They have priority over files of the same name; such a file is given as ./NAME.
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
