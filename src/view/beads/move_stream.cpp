#include "view/beads/move_stream.h"

#include "base/error.h"
#include "gcode/container/input_bytes.h"
#include "view/beads/bead_stream.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace stratum::view {
namespace {

constexpr std::size_t kPartRecords = 16384;  // half a megabyte

}  // namespace

bool MoveStream::sendPart() {
    if (!records_ || generation_ != document_.generation()) {
        records_.reset();
        std::string why = whyNoBeads(document_);
        if (why.empty()) {
            try {
                document_.requireFiles();
                const gcode::InputBytes file(document_.given().objects.front().vdb, gcode::InputBytes::Streams::refuse);
                records_ = movesOf(file.bytes(), file.name(), document_.given().options.tracing.prints.print.read,
                                   *document_.toolpath(0));
            } catch (const InputError& error) {
                why = error.what();
            }
        }
        if (!why.empty()) {
            output_.picture({{"type", "no-moves"}, {"text", why}}, {});
            return false;
        }
        generation_ = document_.generation();
        next_ = 0;
        output_.picture({{"type", "moves"}, {"generation", generation_}, {"count", records_->size()}}, {});
        if (!records_->empty()) return true;
        records_.reset();
        return false;
    }
    const std::size_t count = std::min(kPartRecords, records_->size() - next_);
    std::vector<std::uint8_t> bytes(count * sizeof(MoveRecord));
    std::memcpy(bytes.data(), records_->data() + next_, bytes.size());
    output_.picture({{"type", "move-part"}, {"generation", generation_}}, bytes);
    next_ += count;
    if (next_ < records_->size()) return true;
    records_.reset();  // the page has them now
    return false;
}

}  // namespace stratum::view
