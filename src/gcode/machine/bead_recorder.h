// Converts extruding moves and slicer tags into beads, runs, arcs, layers and objects.
#pragma once

#include "gcode/printer/mixer.h"
#include "gcode/slicer/slicer_tags.h"
#include "gcode/toolpath/frame.h"
#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace stratum::gcode {

/// Builds a Toolpath. Layers are counted by the slicer's marks; before the first mark, and in files without any, by the
/// z of extrusion: a new layer begins if z rises above the current layer's, or returns to the first layer's (the next
/// of several objects printed one after another). Travel doesn't count.
class BeadRecorder {
public:
    /// `nominal_height` (mm) separates the layers of a spiral.
    BeadRecorder(double nominal_height, std::size_t expected_beads, WarningLog& warnings);

    /// Slic3r and its kin write no numbered marks: a user's own program does, for each object of a layer.
    void letMarksRepeat() { marks_repeat_ = true; }
    void tag(const Tag& tag, std::uint32_t line);
    /// The start program ends here: in files without layer marks, what was laid before is no part of the print.
    void startPart();
    /// To be called behind the program. A print that has marks of layers, but none before the last bead, is counted by
    /// z after all.
    void finish();
    void setTool(std::uint8_t tool) { next_.tool = tool; }
    void setSpeed(double speed) { next_.speed = static_cast<float>(speed); }
    void startObject(std::string_view name, std::uint32_t line);
    void stopObject() { next_.object = 0; }
    /// isPlainLayerMark(): counts where z does not tell layers.
    void plainMark() { plain_marks_.push_back(toolpath_.beads.size()); }
    /// Renames the current object; if another object has that name, it becomes the current one.
    void renameObject(std::string_view name, std::uint32_t line);
    /// M600: a manual change of filament. Warns if no tag has announced it: the new color is then left open.
    void changeFilament(std::uint32_t line);
    /// The nozzle of a tool shall have this temperature, in degrees Celsius, from this line on. Nothing is printed by
    /// one that is off.
    void heat(double tool, double temperature, std::uint32_t line);
    /// The fan of the part shall have this speed, in per cent.
    void blow(double speed, std::uint32_t line);
    /// What prints shall accelerate by this, in mm/s^2.
    void accelerate(double acceleration, std::uint32_t line);
    /// The pressure advance of a tool, in s.
    void advance(double tool, double seconds, std::uint32_t line);
    /// A tool lays another mix of filaments from here on.
    void changeMix(ToolMix mix, std::uint32_t line);
    const std::vector<MixChange>& mixes() const { return mixes_; }
    /// Filament (mm) is pushed out in place beyond what was drawn back. Counts between lines of the print alone.
    void prime(double mm) { toolpath_.primed_mm += next_.layer > 0 ? mm : 0; }
    /// mm, as tagged; 0 if unknown.
    double height() const { return static_cast<double>(next_.height); }

    /// Adds a bead of `volume` mm^3 whose path is `length` mm long (> 0).
    void add(const Point& from, const Point& to, const std::optional<Arc>& arc, double length, double volume,
             std::uint32_t line);

    /// The toolpath so far, widths still areas and heights where tagged: input to resolveSections().
    Toolpath& toolpath() { return toolpath_; }
    /// By run: the z of its level beads, or NaN if they are sloped.
    const std::vector<double>& runZ() const { return run_z_; }

    /// Layers by plain marks, where z does not tell them; when heights are known, which count the layers of spirals.
    void countPlainMarks();

private:
    /// The number of an object that its name has marked already: OrcaSlicer writes both.
    bool isSecondMark(std::string_view name) const;
    void changeColor(std::uint8_t tool, std::optional<Rgb> color, std::uint32_t line);
    static double intendedHeight(double mm);
    double squeezed(double height) const;
    void markLayer(const Tag& tag);
    /// How often level beads rise, counted up to `most`.
    std::size_t levels(std::size_t most) const;
    void markOnRaft(bool raft);
    void restartLayers();
    void countLayer(const Point& from, const Point& to, bool sloped);

    Toolpath toolpath_;
    std::vector<double> run_z_;
    std::vector<MixChange> mixes_;
    Run next_;
    double nominal_height_;
    std::vector<std::size_t> plain_marks_;  // beads before each
    bool layer_marks_ = false;
    bool part_started_ = false;
    bool features_ = false;         // some tag has named one
    std::string_view mark_;         // the words of the last layer mark
    bool marked_twice_ = false;     // others came behind it, without a bead between
    std::optional<double> mark_z_;  // its z, if it states one
    std::size_t beads_before_mark_ = 0;
    bool marks_repeat_ = false;
    bool repeats_ = false;  // the mark may be of the layer before it
    int on_raft_ = 0;       // layer marks until heights are those of the levels again
    double first_z_ = 0;
    double layer_z_ = 0;
    std::unordered_map<std::string, std::uint16_t> object_index_;
    WarningLog& warnings_;
};

}  // namespace stratum::gcode
