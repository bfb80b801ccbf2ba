#include "gcode/slicer/extrusion_scan.h"

#include "gcode/text/lexer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

namespace stratum::gcode {
namespace {

constexpr std::size_t kEnoughMoves = 400;
constexpr std::size_t kFewestPairs = 11;
// Absolute E decreases only in wipes. Of increments that differ, about half are smaller than the one before.
constexpr std::size_t kFallsInChanges = 4;
// Absolute E rises wherever plastic is laid. Numbers that hardly ever rise are equal increments.
constexpr std::size_t kPairsInRises = 16;

// How E changes between moves in the plane.
class Changes {
public:
    void add(bool plan, double e) {
        if (!plan && last_ && e > 0 && e < *last_) drawn_back_ = true;
        if (plan) {
            ++moves_;
            if (last_) {
                ++pairs_;
                if (e > *last_) ++rises_;
                if (e < *last_) ++falls_;
            }
        }
        if (last_) {
            net_ += e - *last_;
            gross_ += std::abs(e - *last_);
        }
        last_ = e;
    }
    // E was set, or moves are left out.
    void restart() { last_.reset(); }

    bool enough() const { return moves_ >= kEnoughMoves; }
    bool areIncrements() const {
        // Absolute E climbs all the same, where each line begins with a wipe.
        const bool climbs = net_ > 0.5 * gross_;
        const bool falls = falls_ * kFallsInChanges > rises_ + falls_ && !climbs;
        return pairs_ >= kFewestPairs && (falls || rises_ * kPairsInRises <= pairs_);
    }
    // Some number is not above the one before, and none shows a retraction as absolute E writes it: back to less, in
    // place, where an increment would push out.
    bool repeat() const { return rises_ < pairs_ && !drawn_back_; }

private:
    std::size_t moves_ = 0;
    std::size_t pairs_ = 0;  // of moves that follow each other
    std::size_t rises_ = 0;
    std::size_t falls_ = 0;
    bool drawn_back_ = false;
    std::optional<double> last_;
    double net_ = 0, gross_ = 0;  // mm
};

// Whether the first E is where a part of a program begins that counts absolute E from before: far more a length than
// what follows. Marlin lays nothing in such a move, either (EXTRUDE_MAXLENGTH, 200 mm).
class Beginning {
public:
    // A move with E. False once all is known.
    bool extrude(const Command& command) {
        const double e = command.value('E');
        const double length = go(command);
        if (moves_ == 0) {
            first_ = command.has('X') || command.has('Y') ? e : 0;
            first_length_ = length;
        } else {
            filament_ += std::max(e - e_, 0.0);
            length_ += length;
        }
        e_ = e;
        ++moves_;
        return open();
    }
    void travel(const Command& command) { go(command); }
    bool open() const { return !whole_ && first_ > kFirst && moves_ < kMoves; }

    // E was set: behind the first move with it, that was a purge.
    void set() {
        if (moves_ > 0) whole_ = true;
    }

    bool cut() const {
        constexpr double kMore = 10;
        return !whole_ && first_ > kFirst && moves_ >= kFewest && filament_ > 0 &&
               first_ * length_ > kMore * filament_ * first_length_;
    }

private:
    static constexpr double kFirst = 200;  // mm
    static constexpr int kMoves = 12;
    static constexpr int kFewest = 4;

    double go(const Command& command) {
        const double x = command.hasValue('X') ? command.value('X') : x_;
        const double y = command.hasValue('Y') ? command.value('Y') : y_;
        const double length = std::hypot(x - x_, y - y_);
        x_ = x;
        y_ = y;
        return length;
    }

    double x_ = 0, y_ = 0, e_ = 0;
    double first_ = 0, first_length_ = 0;
    double filament_ = 0, length_ = 0;  // of the moves behind the first
    int moves_ = 0;
    bool whole_ = false;
};

class Scanner {
public:
    // False once all is known.
    bool command(const Command& command) {
        if (command.kind == Command::Kind::numbered) {
            if (command.letter == 'M') return miscellaneous(command.code);
            motion_ = command.letter == 'G' && command.code <= 3;
            if (command.letter == 'G' && command.code == 92 && command.has('E')) {
                changes_.restart();
                beginning_.set();
            }
            if (!motion_) return true;
        } else if (command.kind == Command::Kind::extended || !motion_) {
            return true;
        }
        const bool plan = command.has('X') || command.has('Y');
        if (command.hasValue('E')) return extrusion(plan, command);
        beginning_.travel(command);
        bare_on_ = bare_on_ || (plan && on_);
        if (plan && (command.hasValue('A') || command.hasValue('B'))) ++ab_moves_;
        return true;
    }

    ExtrusionScan result() const {
        using Drive = ExtrusionScan::Drive;
        // Skeinforge's own moves have no E; a purge in the start program may.
        if (bare_on_ && !e_on_ && !mode_) return {.drive = Drive::switched};
        // A prime line in the start program of MakerBot's machines may have E, too.
        constexpr std::size_t kMostPrimes = 10;
        if (ab_moves_ > e_moves_ && e_moves_ < kMostPrimes && !(mode_ && e_) && !spindle_)
            return {.drive = Drive::axes_ab};
        if (!e_) return {.drive = switch_ ? Drive::switched : Drive::e_word};
        return {.falls_back = changes_.areIncrements(),
                .mode_follows = mode_follows_,
                .repeats = changes_.repeat(),
                .cut = beginning_.cut()};
    }

private:
    bool miscellaneous(int code) {
        if (code == 101) switch_ = on_ = true;
        if (code == 103) on_ = false;
        if (code == 3 || code == 4) spindle_ = true;
        if (code == 82 || code == 83) {
            mode_ = true;
            mode_follows_ = e_;
        }
        return !(mode_ && e_ && !beginning_.open());
    }

    bool extrusion(bool plan, const Command& command) {
        e_ = true;
        if (plan) ++e_moves_;
        e_on_ = e_on_ || on_;
        const bool more = beginning_.extrude(command);
        if (mode_) return more;
        changes_.add(plan, command.value('E'));
        return more || !changes_.enough();
    }

    bool motion_ = false;
    bool mode_ = false;
    bool mode_follows_ = false;
    bool switch_ = false;
    bool on_ = false;                         // between M101 and M103
    bool e_on_ = false;                       // E moves there
    bool bare_on_ = false;                    // moves there have none
    std::size_t e_moves_ = 0, ab_moves_ = 0;  // in the plane
    bool spindle_ = false;                    // then A and B turn what is milled
    bool e_ = false;
    Changes changes_;
    Beginning beginning_;
};

// Finds lines that may have a command. All calls together search every byte once.
class LineFinder {
public:
    // `command`: a letter and two digits.
    LineFinder(std::string_view bytes, std::string_view command) : bytes_(bytes), command_(command), next_(search(0)) {}

    // The first such line at or behind `from`, which is the start of a line; npos if there is none.
    std::size_t from(std::size_t from) {
        if (next_ < from) next_ = search(from);
        return next_;
    }

private:
    std::size_t search(std::size_t from) const {
        const void* const hit = ::memmem(bytes_.data() + from, bytes_.size() - from, command_.data(), command_.size());
        if (hit == nullptr) return std::string_view::npos;
        const auto skipped = static_cast<std::size_t>(static_cast<const char*>(hit) - bytes_.data()) - from;
        const auto end = bytes_.substr(from, skipped).find_last_of("\r\n");
        return end == std::string_view::npos ? from : from + end + 1;
    }

    std::string_view bytes_;
    std::string_view command_;
    std::size_t next_;
};

// Adds the moves in `bytes` until something sets E's mode anew, or there are enough.
void countChanges(std::string_view bytes, Changes& changes) {
    changes.restart();
    Lexer lexer(bytes);
    Line line;
    while (!changes.enough() && lexer.next(line)) {
        for (std::size_t i = 0; i < line.count; ++i) {
            const Command& command = line.commands[i];
            const bool set = command.letter == 'M' && (command.code == 82 || command.code == 83);
            if (set || (command.letter == 'G' && command.subcode == 0 && (command.code == 90 || command.code == 91)))
                return;
            if (command.letter == 'G' && command.code == 92 && command.has('E')) changes.restart();
            const bool motion = command.kind == Command::Kind::words || (command.letter == 'G' && command.code <= 3);
            if (motion && command.hasValue('E')) changes.add(command.has('X') || command.has('Y'), command.value('E'));
        }
    }
}

}  // namespace

bool fallsBackAfterG90(std::string_view bytes) {
    constexpr auto kNone = std::string_view::npos;
    LineFinder m83(bytes, "M83");
    if (m83.from(0) == kNone) return false;
    LineFinder m82(bytes, "M82");
    LineFinder g90(bytes, "G90");
    Changes changes;
    bool relative = false;  // as a slicer sees it, for which G90 changes nothing
    std::size_t at = 0;
    while (!changes.enough()) {
        at = relative ? std::min(m82.from(at), g90.from(at)) : m83.from(at);
        if (at == kNone) break;
        Lexer lexer(bytes.substr(at));
        Line line;
        bool undone = false;
        lexer.next(line);
        for (std::size_t i = 0; i < line.count; ++i) {
            const Command& command = line.commands[i];
            if (command.subcode != 0) continue;
            if (command.letter == 'M' && (command.code == 82 || command.code == 83)) relative = command.code == 83;
            undone = relative && (undone || (command.letter == 'G' && command.code == 90));
        }
        at += lexer.offset();
        if (undone) countChanges(bytes.substr(at), changes);
    }
    return changes.areIncrements();
}

ExtrusionScan scanExtrusion(std::string_view bytes) {
    Scanner scanner;
    Lexer lexer(bytes);
    Line line;
    bool more = true;
    while (more && lexer.next(line))
        for (std::size_t i = 0; more && i < line.count; ++i) more = scanner.command(line.commands[i]);
    return scanner.result();
}

}  // namespace stratum::gcode
