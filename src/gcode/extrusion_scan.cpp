#include "gcode/extrusion_scan.h"

#include "gcode/lexer.h"

namespace stratum::gcode {
namespace {

constexpr std::size_t kEnoughMoves = 400;
constexpr std::size_t kFewestMoves = 12;
// Of E that counts on, only wipes fall; of increments, about half are smaller than the one before.
constexpr std::size_t kFallsInMoves = 4;

class Scanner {
public:
    // False once all is known.
    bool command(const Command& command) {
        if (command.kind == Command::Kind::numbered) {
            if (command.letter == 'M') return miscellaneous(command.code);
            motion_ = command.letter == 'G' && command.code <= 3;
            if (command.letter == 'G' && command.code == 92 && command.has('E')) last_ = 0;
            if (!motion_) return true;
        } else if (command.kind == Command::Kind::extended || !motion_) {
            return true;
        }
        const bool plan = command.has('X') || command.has('Y');
        if (command.hasValue('E')) return extrusion(plan, command.value('E'));
        if (plan && (command.hasValue('A') || command.hasValue('B'))) ab_ = true;
        return true;
    }

    ExtrusionScan result() const {
        using Drive = ExtrusionScan::Drive;
        if (e_) return {.falls_back = moves_ >= kFewestMoves && falls_ * kFallsInMoves > moves_};
        return {.drive = ab_ ? Drive::axes_ab : switch_ ? Drive::switched : Drive::e_word};
    }

private:
    bool miscellaneous(int code) {
        if (code == 82 || code == 83) mode_ = true;
        if (code == 101) switch_ = true;
        return !(mode_ && e_);
    }

    bool extrusion(bool plan, double value) {
        e_ = true;
        if (mode_) return false;
        if (!plan) {
            last_ = value;
            return true;
        }
        if (value < last_) ++falls_;
        last_ = value;
        return ++moves_ < kEnoughMoves;
    }

    bool motion_ = false;
    bool mode_ = false;
    bool switch_ = false;
    bool ab_ = false;
    bool e_ = false;
    double last_ = 0;
    std::size_t moves_ = 0;
    std::size_t falls_ = 0;
};

}  // namespace

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
