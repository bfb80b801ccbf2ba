// What a page needs that draws beads itself, part by part.
#pragma once

#include "view/beads/bead_table.h"
#include "view/document.h"
#include "view/output.h"
#include "view/view_scene.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace stratum::view {

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
