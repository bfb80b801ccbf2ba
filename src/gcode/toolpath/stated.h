// Statements of a file about its print: time, weight, material, nozzle, printer, layer heights. Nothing is computed;
// values that the file doesn't state are absent.
// Sources: PrusaSlicer, SuperSlicer, OrcaSlicer and BambuStudio GCode.cpp ("estimated printing time (normal mode) =",
// "total filament used [g] =", "model printing time: ...; total estimated time:", their settings); Cura's ";TIME:" and
// Griffin headers ("PRINT.TIME:"); Simplify3D ("Build time:", "Plastic weight:", its settings with commas:
// filamentDensities, filamentPricesPerKg, strokeXoverride); ideaMaker
// ("Print Time:", "Belt Printer: 1", "Belt Gantry Angle: 45"); KISSlicer ("Estimated Build Time: 332.83 minutes");
// Kiri:Moto ("--- print time: 806s ---", "Bed type: belt");
// FlashPrint ("machine_type:", "right_extruder_material:") and the header of its .gx; Snapmaker Luban
// ("estimated_time(s):", "Extruder 0 Material:"); Creality Print ("Machine Name:", "Material Type:").
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// Lists are by tool (T number).
struct StatedFacts {
    std::optional<double> seconds;             ///< of the whole job, warming up included where the slicer counts it
    std::optional<double> model_seconds;       ///< of the printing alone (BambuStudio)
    std::optional<double> grams;               ///< all filament
    std::optional<double> cost;                ///< of all filament, in the user's currency
    std::vector<std::string> materials;        ///< as the slicer names them, e.g. "PLA"
    std::vector<std::string> profiles;         ///< names of the filaments' settings, e.g. "Generic PLA Silk @MK4"
    std::vector<double> nozzle_diameters;      ///< mm
    std::vector<double> densities;             ///< g/cm^3, of the filament; 0 for a tool without one
    std::vector<double> prices;                ///< of a kg of filament, in the user's currency; 0 without one
    std::string printer;                       ///< the model, or else the name of its profile
    std::optional<double> layer_height;        ///< mm
    std::optional<double> first_layer_height;  ///< mm
    std::vector<std::array<double, 2>> bed;    ///< mm, corners of the printable area; empty, or at least three
    std::vector<std::vector<std::array<double, 2>>> excluded;  ///< mm, corners of areas of the bed that stay free
    bool belt = false;                                         ///< it is a printer with a belt
    std::optional<double> belt_angle;                          ///< degrees between its gantry and the belt (ideaMaker)
    bool programs_left_out = false;  ///< `seconds` is without the user's start and end programs (Cura)

    bool empty() const;
};

/// Collects the facts from comments; of several that state the same, the last one counts.
class StatedReader {
public:
    /// Parses a comment, without its ';' and trimmed, if it states one of them.
    void comment(std::string_view text);
    /// The facts, with a first layer's height in per cent converted to mm. To be called once, at the end.
    StatedFacts finish();

private:
    void pair(std::string_view key, std::string_view value);
    void sentence(std::string_view key, std::string_view value);
    void setting(std::string_view key, std::string_view value);
    void setExcluded(std::string_view areas);
    void setBedSide(std::size_t axis, std::string_view length);
    void setMaterial(std::size_t tool, std::string_view name);
    static void setNumbers(std::string_view list, double most, std::vector<double>& numbers);
    void setNozzle(std::size_t tool, std::string_view diameter);

    StatedFacts facts_;
    std::optional<double> elapsed_;      // s, the last ;TIME_ELAPSED
    std::string profile_;                // the printer's settings, where no model is named
    std::optional<double> first_share_;  // of the layer height
    std::array<double, 2> bed_sides_{};  // mm; 0: not stated
    bool total_grams_ = false;           // the sum is stated, not only its parts
    bool total_cost_ = false;            // the same
};

/// Seconds of "1d 2h 3m 4s", "1h:20m:36s", "0 hours 43 minutes", "332.83 minutes", "806s" or a bare number of seconds;
/// nullopt for anything else.
std::optional<double> parseDuration(std::string_view text);

/// "1 h 14 min 1 s".
std::string describeDuration(double seconds);

}  // namespace stratum::gcode
