// The moves of a program on their way to a page that has asked for them.
#pragma once

#include "view/beads/move_table.h"
#include "view/document.h"
#include "view/output.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace stratum::view {

/// For one page and one thread. Messages: "moves" with the number of records, then "move-part" with records, or
/// "no-moves" with the reason.
class MoveStream {
public:
    MoveStream(Document& document, const Output& output) : document_(document), output_(output) {}

    /// Sends the next part of what the document holds now. Returns whether there is more.
    bool sendPart();

private:
    Document& document_;
    const Output& output_;
    std::optional<std::vector<MoveRecord>> records_;
    std::uint64_t generation_ = 0;  // of the records
    std::size_t next_ = 0;          // record
};

}  // namespace stratum::view
