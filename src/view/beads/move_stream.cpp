#include "view/beads/move_stream.h"

#include "base/error.h"
#include "gcode/container/container.h"
#include "view/beads/bead_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

namespace stratum::view {
namespace {

constexpr std::size_t kMostRecords = std::size_t{1} << 21;  // 64 MB on the page's GPU
constexpr std::uint32_t kMostLine = (1U << 28) - 1, kContinued = 1U << 31;
constexpr double kStandstill = 1e-12;  // mm
constexpr double kArcStep = 0.2;       // radians

using Place = std::array<double, 3>;  // mm

bool isOuter(gcode::Feature feature) {
    return feature == gcode::Feature::external_perimeter || feature == gcode::Feature::overhang_perimeter;
}

class MoveCollector final : public gcode::MotionSink {
public:
    explicit MoveCollector(const gcode::Toolpath& shown) : shown_(shown) {}

    void limits(const gcode::MachineLimits&) override {}
    void wait(double) override {}
    void stop(gcode::Stop kind, std::uint32_t line) override {
        constexpr std::array kKinds{MoveKind::tool_change, MoveKind::pause, MoveKind::filament_change};
        add(kKinds[static_cast<std::size_t>(kind)], place_, place_, line);
    }
    void move(const gcode::Move& move) override {
        const Place from = move.start;
        place_ = {from[0] + move.delta[0], from[1] + move.delta[1], from[2] + move.delta[2]};
        if (move.bead != gcode::Move::kNoBead) return lay(move);
        const auto moves = [](double delta) { return std::abs(delta) > kStandstill; };
        const bool travels = move.sweep != 0 || moves(move.delta[0]) || moves(move.delta[1]) || moves(move.delta[2]);
        const bool draws_back = move.delta[3] < 0;
        if (!travels) return add(draws_back ? MoveKind::retraction : MoveKind::recovery, from, from, move.line);
        travelled_ = true;
        const MoveKind kind = draws_back ? MoveKind::wipe : MoveKind::travel;
        const int pieces = std::max(1, static_cast<int>(std::ceil(std::abs(move.sweep) / kArcStep)));
        Place last = from;
        for (int n = 1; n <= pieces; ++n) {
            const Place next = n == pieces ? place_ : onArc(move, static_cast<double>(n) / pieces);
            add(kind, last, next, move.line, n > 1 ? kContinued : 0);
            last = next;
        }
    }

    std::vector<MoveRecord> records;

private:
    void lay(const gcode::Move& move) {
        if (move.bead >= shown_.beads.size()) return;  // told by who compares the numbers of beads
        const gcode::Feature feature = shown_.runOf(shown_.beads[move.bead]).feature;
        next_ = move.bead;
        if (feature == gcode::Feature::external_perimeter && (travelled_ || !outer_))
            add(MoveKind::seam, move.start, move.start, move.line);
        outer_ = isOuter(feature);
        travelled_ = false;
        next_ = move.bead + 1;
    }
    static Place onArc(const gcode::Move& move, double share) {
        const double angle = share * move.sweep;
        const double x = -move.center.x, y = -move.center.y;  // of the start, from the center
        return {move.start[0] + move.center.x + x * std::cos(angle) - y * std::sin(angle),
                move.start[1] + move.center.y + x * std::sin(angle) + y * std::cos(angle),
                move.start[2] + share * move.delta[2]};
    }
    void add(MoveKind kind, const Place& from, const Place& to, std::uint32_t line, std::uint32_t continued = 0) {
        if (records.size() == kMostRecords)
            throw InputError(
                fmt::format("more than {} travels, retractions and other moves; no more fit the page", kMostRecords));
        const auto mm = [](double value) { return static_cast<float>(value); };
        records.push_back({mm(from[0]), mm(from[1]), mm(from[2]), mm(to[0]), mm(to[1]), mm(to[2]), next_,
                           std::min(line, kMostLine) | static_cast<std::uint32_t>(kind) << 28 | continued});
    }

    const gcode::Toolpath& shown_;
    Place place_{};
    std::uint32_t next_ = 0;  // beads that are laid
    bool travelled_ = true;   // since the last bead
    bool outer_ = false;      // the last bead was of an outer line
};

}  // namespace

std::vector<MoveRecord> movesOf(std::string_view bytes, std::string_view name, gcode::ReadOptions options,
                                const gcode::Toolpath& shown) {
    if (shown.belt_angle != 0) throw InputError("travels of printers with a belt are not drawn");
    if (options.deposit.flow_lag || options.deposit.sag > 0)
        throw InputError("travels are not drawn beside beads that lag or sag: start the viewer without these options");
    MoveCollector collector(shown);
    options.motion = &collector;
    options.progress = nullptr;
    const gcode::Toolpath read = gcode::readToolpath(bytes, name, options);
    if (read.beads.size() != shown.beads.size())
        throw InputError(fmt::format("{}: has changed since it was read; it is read again soon", name));
    return std::move(collector.records);
}

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
