// What a page needs that draws beads itself, part by part.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "view/input/document.h"
#include "view/input/output.h"
#include "view/input/view_scene.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace stratum::view {

// The beads of a print for a page that draws them itself: 16 bytes each.

/// A row of texels, in the order of the print; a texel is four words of 32 bits. That of a bead:
///   x0 | y0 << 16,  x1 | y1 << 16,  z0 | z1 << 16   the nozzle at its ends, in steps of `grain` from `low`,
///                                               the corner of the box of all paths
///   width | extra << 12 | run << 13                 in steps of 4 micrometres; 1 if a texel follows that belongs to it
/// and of what follows an arc, or a bead that widens, as floats:
///   x and y of the center from `low`, sweep in radians (0: no arc), width at its end less width at its start
/// Ends are off by at most half a step: 2 micrometres for a print of 250 mm.
class BeadTable {
public:
    /// Throws InputError, with the reason, if the print does not fit such a table.
    explicit BeadTable(std::shared_ptr<const gcode::Toolpath> toolpath);

    std::size_t texels() const { return texels_; }
    /// What goes before the texels. "kinds" says what of the shader is needed; "printed" has by half per cent of volume
    /// and of time the number of beads that are printed then.
    nlohmann::json head() const;
    /// Four words by run: height and height of the straight sides, mm (floats); layer; feature | tool << 8 | object <<
    /// 16. Behind all of them, by run the programmed speed in mm/s (float).
    const std::vector<std::uint32_t>& runs() const { return runs_; }
    /// Texels of the beads from `bead` on, about `count` of them; `bead` becomes the next one.
    std::vector<std::uint32_t> part(std::size_t& bead, std::size_t count) const;
    std::size_t beads() const { return toolpath_->beads.size(); }
    /// Whether a bead takes two texels.
    bool hasExtra(const gcode::Bead& bead) const;

private:
    std::uint32_t step(double mm, std::size_t axis) const;

    const std::shared_ptr<const gcode::Toolpath> toolpath_;
    std::array<double, 3> low_{}, grain_{};  // mm
    std::vector<std::uint32_t> runs_;
    std::size_t texels_ = 0;
    bool arcs_ = false, tapers_ = false, slopes_ = false, corners_ = false;
};

/// Why a page can't draw this input; empty if it can.
std::string whyNoBeads(const Document& document);

/// For one page and one thread. Messages: "beads" with the runs, then "bead-part" with texels, or "no-beads" with the
/// reason; "look" (bead_look.h), and "colors" with 16 bits a texel if they have changed.
class BeadStream {
public:
    BeadStream(Document& document, const Output& output) : document_(document), output_(output) {}

    /// Sends the next part of what the document holds now. Returns whether there is more.
    bool sendPart();
    /// Sends how the objects of `scene` look in a picture of theirs, with what has changed since the last call.
    void sendLook(const ViewedPicture& picture, const PicturePlan& plan, ViewScene& scene, std::uint64_t number);

private:
    Document& document_;
    const Output& output_;
    std::unique_ptr<const BeadTable> table_;
    std::uint64_t generation_ = 0;  // of the table
    std::size_t next_ = 0;          // bead
    std::string light_key_;         // of the light that was sent last
    std::optional<std::string> colors_key_;
};

}  // namespace stratum::view
