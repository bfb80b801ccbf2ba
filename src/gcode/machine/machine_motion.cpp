// Machine's moves and extrusion.
#include "gcode/machine/machine.h"
#include "gcode/text/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace stratum::gcode {
namespace {

constexpr double kNoMotion = 1e-9;  // mm
constexpr double kFullTurn = 2 * std::numbers::pi;
constexpr int kMostTurns = 100;  // Marlin's bound on P
// Filament retracted further than this, in mm, is unloaded: the longest retractions of Bowden printers are 16 mm,
// unloading takes 50 and more.
constexpr double kUnloaded = 25;
constexpr double kMostClimb = 50;         // layers that a line rises through, steeply; wireframes have less
constexpr double kThinnestThread = 0.05;  // mm of diameter, of one that goes straight up; less is rounding
constexpr double kThickestThread = 1.5;   // more is a purge
constexpr double kSwitchedHeight = 0.25;  // mm, typical of printers with switched extruders (M101, M103)
constexpr double kSwitchedAspect = 1.6;   // their usual width over height (Skeinforge's default)

// Not std::hypot, which guards against overflow that kMaxCoordinate excludes, and costs a quarter of the reading time.
double norm(double a, double b) { return std::sqrt(a * a + b * b); }

// The slot number of a stored position: 0 by default; clamped to [0, 255].
int slotOf(const Command& command, char letter) {
    return command.hasValue(letter) ? static_cast<int>(std::clamp(command.value(letter), 0.0, 255.0)) : 0;
}

double distance(const Point& a, const Point& b) { return norm(norm(b.x - a.x, b.y - a.y), b.z - a.z); }

}  // namespace

double Machine::takeAxis(const Command& command, char letter, std::size_t axis) const {
    const double current = frame_.position()[axis];
    if (!command.hasValue(letter)) return current;
    const double value = command.value(letter) * unit_;
    const double target = absolute_ ? value + frame_.offset()[axis] : current + value;
    if (!(std::abs(target) <= kMaxCoordinate))
        refuse(fmt::format("{}{} is no place on a printer (limit {} mm); is the file damaged?", letter,
                           command.value(letter), kMaxCoordinate));
    return target;
}

char Machine::extruderAxis(const Command& command) const {
    if (command.has('E')) return 'E';
    if (settings_.extrusion.drive != ExtrusionScan::Drive::axes_ab) return 0;
    return command.has('A') ? 'A' : command.has('B') ? 'B' : '\0';
}

void Machine::useExtruderOf(char axis) {
    if (axis != 'A' && axis != 'B') return;
    if (const std::size_t tool = axis == 'B' ? 1 : 0; tool != tool_) useTool(tool);
}

double Machine::takeExtrusion(const Command& command) {
    const char letter = extruderAxis(command);
    useExtruderOf(letter);
    if (letter == 0 || !command.hasValue(letter)) return 0;
    if (!e_mode_known_) assumeExtruderMode();
    const double value = command.value(letter) * eUnit();
    if (tool_e_) {
        if (e_absolute_ && std::abs(value - *tool_e_) <= std::abs(value - e_)) e_ = *tool_e_;
        tool_e_.reset();
    }
    if (!e_begun_ && e_absolute_ && e_ == 0 && settings_.extrusion.cut) {
        warn(
            fmt::format("the first E is {:g}, far more than a line holds: the program is a part of another that counts "
                        "E from before; E counts from there",
                        command.value(letter)));
        e_ = value;
    }
    e_begun_ = true;
    const double extrusion = e_absolute_ ? value - e_ : value;
    if (!(std::abs(extrusion) <= kMaxExtrusion))
        refuse(fmt::format("{}{} is no extrusion (limit {} in one move); is the file damaged?", letter,
                           command.value(letter), kMaxExtrusion));
    e_ = e_absolute_ ? value : e_ + value;
    return extrusion;
}

void Machine::assumeExtruderMode() {
    // No M82 or M83 before the first extrusion. If one follows, this is a start program on a machine that was just
    // switched on, with absolute E, unless the numbers tell otherwise. If none does, it may be in a start macro of the
    // printer: the mode follows from the slicer's settings, or from the numbers. On MakerBot's machines A and B are
    // always absolute.
    e_mode_known_ = true;
    const ExtrusionScan& scan = settings_.extrusion;
    if (scan.mode_follows && !e_follows_axes_) {
        e_absolute_ = !scan.repeats;
        if (scan.repeats)
            warn(
                "the first M82 or M83 comes late, and E before it does not rise from move to move, as only "
                "increments do; it is taken as relative there (--e-mode absolute if not)");
    } else if (settings_.relative_e) {
        e_absolute_ = !*settings_.relative_e;
    } else if (scan.drive == ExtrusionScan::Drive::axes_ab) {
        e_absolute_ = true;
    } else if (scan.falls_back) {
        e_absolute_ = false;
        warn(
            "neither M82 nor M83 before the first extrusion, and E keeps falling back or stays the same, as only "
            "increments do; E is taken as relative (--e-mode absolute if not)");
    } else if (!e_follows_axes_ && !settings_.volumetric_e.value_or(false)) {  // Cura writes no M82 for an Ultimaker 2
        warn("neither M82 nor M83 before the first extrusion; E is taken as absolute (--e-mode relative if not)");
    }
}

bool Machine::refusesLetters(const Command& command) {
    bool missing = false;
    for (const char letter : {'X', 'Y', 'Z', 'E', 'F', 'I', 'J', 'R'}) {
        if (!command.has(letter) || command.hasValue(letter)) continue;
        if (command.isExpression(letter)) {
            warn(fmt::format("{}{{...}} is an expression, whose value isn't in the file; {}", letter,
                             letter == 'F' ? "the speed is unknown from there on" : "it is left out"));
        } else if (firmware_ == Firmware::marlin) {
            warn(fmt::format("{} without a number in a move; it is left out, as Marlin does", letter));
        } else {
            missing = true;
            warn(fmt::format("{} without a number: {} refuses such a move; it is left out", letter,
                             firmwareName(firmware_)));
        }
    }
    return missing;
}

void Machine::move(const Command& command, int motion) {
    if (command.lacksNumbers() && refusesLetters(command)) return;
    if (command.isExpression('F')) {
        feed_ = 0;
        recorder_.setSpeed(0);
    }
    if (extra_axes_.has(command)) moveExtraAxes(command);
    const Point& at = frame_.position();
    Point target{takeAxis(command, 'X', 0), takeAxis(command, 'Y', 1), takeAxis(command, 'Z', 2)};
    if (const Point* stored = restorePoint(command, motion)) target = targetFrom(*stored, command);
    if (command.hasValue('F') && command.value('F') > 0) {
        // Under G93, F is one over the minutes that the move takes.
        move_seconds_ = 60 / command.value('F');
        feed_ = inverse_time_ ? distance(at, target) / move_seconds_ : command.value('F') * unit_ / 60;
        recorder_.setSpeed(feed_ * speed_factor_);
    }
    const double drive = takeExtrusion(command);
    if (inverse_time_ && feed_ == 0 && motion < 2) feed_ = std::abs(drive) / move_seconds_;  // mm of filament a second
    const bool in_place = target.x == at.x && target.y == at.y && motion < 2;
    const double strut = in_place && drive > 0 && target.z > at.z ? freshOf(drive) : 0;
    double extrusion = drive != 0 ? extrudedOf(drive, in_place) : 0;
    if (strut > 0 && isThread(strut, target.z - at.z)) return runStrut(target, strut, drive);
    const bool switched = motor_on_ && motion > 0 && settings_.extrusion.drive == ExtrusionScan::Drive::switched;
    if (extrusion > 0 || switched) {
        drive_per_extrusion_ = extrusion > 0 ? drive / extrusion : 0;
        const double climb = target.z - at.z;
        if (nominal_height_ > 0 && climb > kMostClimb * nominal_height_ &&
            climb > norm(target.x - at.x, target.y - at.y))
            warn(fmt::format("a line of plastic climbs by {:.1f} mm; is its Z damaged?", climb));
        if (motion < 2)
            runPath(target, std::nullopt, extrusion);
        else if (motion == 5)
            runBezier(command, target, extrusion);
        else
            runArc(command, target, motion == 2, extrusion);
    } else {
        ++counts_.travels;
        if (moves_ != nullptr) recordTravel(command, target, motion, drive);
    }
    frame_.moveTo(target);
}

Point Machine::targetFrom(const Point& stored, const Command& command) const {
    constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};
    Point target = frame_.position();
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (command.has(kAxes[axis])) target[axis] = stored[axis] + coordinateOf(command, kAxes[axis]);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(std::abs(target[axis]) <= kMaxCoordinate))
            refuse(fmt::format("{} = {} is no place on a printer (limit {} mm); is the file damaged?", kAxes[axis],
                               target[axis], kMaxCoordinate));
    return target;
}

const Point* Machine::restorePoint(const Command& command, int motion) {
    if (firmware_ != Firmware::reprap || motion > 1 || !command.hasValue('R')) return nullptr;
    const auto found = stored_.find(slotOf(command, 'R'));
    if (found != stored_.end()) return &found->second.position;
    warn("R names a place that was never stored; it is ignored");
    return nullptr;
}

void Machine::storePosition(const Command& command) {
    if (command.has('Q')) return returnToPosition(command);
    if (!command.has('D')) {
        stored_.insert_or_assign(slotOf(command, 'S'), Stored{frame_.position(), e_});
    } else if (command.hasValue('D')) {
        stored_.erase(slotOf(command, 'D'));
    } else {
        stored_.clear();
    }
}

void Machine::returnToPosition(const Command& command) {
    const auto found = stored_.find(slotOf(command, command.has('Q') ? 'Q' : 'S'));
    if (found == stored_.end()) return warn("G61 to a place that was never stored; ignored");
    const Stored& stored = found->second;
    if (command.has('E')) e_ = stored.e;
    ++counts_.travels;
    const bool all = !command.has('X') && !command.has('Y') && !command.has('Z');
    if (all && command.has('E')) return;
    const Point target = all ? stored.position : targetFrom(stored.position, command);
    if (moves_ != nullptr) recordPath(target, std::nullopt, 0, recorder_.toolpath().beads.size());
    frame_.moveTo(target);
}

void Machine::runPath(const Point& target, const std::optional<Arc>& arc, double extrusion) {
    const Point& at = frame_.position();
    const std::size_t beads_before = recorder_.toolpath().beads.size();
    const double drive = extrusion * drive_per_extrusion_;
    double plan = norm(target.x - at.x, target.y - at.y);
    if (arc) {
        const double radius = 0.5 * (norm(at.x - arc->center_x, at.y - arc->center_y) +
                                     norm(target.x - arc->center_x, target.y - arc->center_y));
        plan = radius * std::abs(arc->sweep);
    }
    if (plan > kNoMotion) {
        const double length = target.z == at.z ? plan : norm(plan, target.z - at.z);
        if (settings_.extrusion.drive == ExtrusionScan::Drive::switched) extrusion = switchedExtrusion(length);
        deposit(target, arc, length, extrusion);
    } else {
        ++counts_.stationary;
    }
    if (moves_ != nullptr) recordPath(target, arc, drive, beads_before);
    frame_.moveTo(target);
}

void Machine::runPieces(const std::vector<Point>& pieces, double extrusion) {
    double total = 0;
    const Point* from = &frame_.position();
    for (const Point& to : pieces) {
        total += distance(*from, to);
        from = &to;
    }
    if (!(total > kNoMotion)) {
        ++counts_.stationary;
        if (moves_ != nullptr)
            recordPath(frame_.position(), std::nullopt, extrusion * drive_per_extrusion_,
                       recorder_.toolpath().beads.size());
        return;
    }
    for (const Point& to : pieces) runPath(to, std::nullopt, extrusion * distance(frame_.position(), to) / total);
}

void Machine::runTurns(const Point& target, const Arc& arc, int turns, double extrusion) {
    const Point start = frame_.position();
    const double total = std::abs(arc.sweep) + turns * kFullTurn;
    Arc circle = arc;
    circle.sweep = std::copysign(kFullTurn, arc.sweep);
    for (int i = 1; i <= turns; ++i) {
        const double z = start.z + (target.z - start.z) * i * kFullTurn / total;
        runPath({start.x, start.y, z}, circle, extrusion * kFullTurn / total);
    }
    runPath(target, arc, extrusion * std::abs(arc.sweep) / total);
}

void Machine::runArc(const Command& command, const Point& target, bool clockwise, double extrusion) {
    const std::optional<Arc> arc = arcOf(command, target, clockwise);
    if (!arc) return runPath(target, std::nullopt, extrusion);
    const int turns =
        command.hasValue('P') ? static_cast<int>(std::clamp(command.value('P'), 0.0, double{kMostTurns})) : 0;
    timeArc(*arc, target, turns);
    if (plane_.normal() == 2)
        return turns > 0 ? runTurns(target, *arc, turns, extrusion) : runPath(target, arc, extrusion);
    const double sweep = arc->sweep + std::copysign(turns * kFullTurn, arc->sweep);
    runPieces(flattenArc(frame_.position(), target, plane_, arc->center_x, arc->center_y, sweep), extrusion);
}

void Machine::runBezier(const Command& command, const Point& target, double extrusion) {
    std::array<double, 4> offsets{};
    constexpr std::array<char, 4> kLetters{'I', 'J', 'P', 'Q'};
    for (std::size_t i = 0; i < 4; ++i) {
        if (!command.hasValue(kLetters[i])) continue;
        offsets[i] = command.value(kLetters[i]) * unit_;
        if (!(std::abs(offsets[i]) <= kMaxCoordinate))
            refuse(fmt::format("{}{} is no curve on a printer (limit {} mm); is the file damaged?", kLetters[i],
                               command.value(kLetters[i]), kMaxCoordinate));
    }
    const Point& start = frame_.position();
    const Point control1{start.x + offsets[0], start.y + offsets[1], start.z};
    const Point control2{target.x + offsets[2], target.y + offsets[3], target.z};
    runPieces(flattenBezier(start, control1, control2, target), extrusion);
}

std::optional<Arc> Machine::arcOf(const Command& command, const Point& target, bool clockwise) {
    constexpr std::array<char, 3> kOffsets{'I', 'J', 'K'};
    const char first = kOffsets[plane_.first];
    const char second = kOffsets[plane_.second];
    for (const char letter : {first, second, 'R'}) {
        if (!command.hasValue(letter)) continue;
        if (!(std::abs(command.value(letter) * unit_) <= kMaxCoordinate))
            refuse(fmt::format("{}{} is no arc on a printer (limit {} mm); is the file damaged?", letter,
                               command.value(letter), kMaxCoordinate));
    }
    const PlanPoint start{frame_.position()[plane_.first], frame_.position()[plane_.second]};
    const PlanPoint end{target[plane_.first], target[plane_.second]};
    std::optional<Arc> arc;
    if (command.hasValue('R')) {
        arc = arcFromRadius(start, end, command.value('R') * unit_, clockwise);
    } else {
        const double i = command.hasValue(first) ? command.value(first) * unit_ : 0;
        const double j = command.hasValue(second) ? command.value(second) * unit_ : 0;
        arc = arcFromOffset(start, end, {i, j}, clockwise);
    }
    if (!arc) warn("arc whose centre, radius and end don't agree; drawn as a straight line");
    return arc;
}

double Machine::extrudedOf(double drive, bool in_place) {
    // Multi-material units swap filament while the head travels over the wipe tower (PrusaSlicer's "CP TOOLCHANGE"):
    // metres of E only bring the filament back. Ordinary retractions are not corrected.
    const double mm = volumetric_ ? drive / filamentArea() : drive;
    const std::size_t nozzle = settings_.shared_nozzle ? 0 : tool_;
    if (flushing_ && in_place) flushed_ += mm;
    constexpr double kRounding = 2e-3;  // mm, of a file's numbers
    double& drawn_back = drawn_back_[nozzle];
    bool& unloaded = unloaded_[nozzle];
    if (in_place && !flushing_ && !unloaded && mm > drawn_back + kRounding) recorder_.prime(mm - drawn_back);
    if (drive < 0) {
        drawn_back -= mm;
        if (drawn_back > kUnloaded) unloaded = true;
        return drive;
    }
    if (!unloaded && in_place) {
        drawn_back = std::max(0.0, drawn_back - mm);
        return drive;
    }
    // A retraction that is taken back in part, or on the way, comes first ("extra restart distance" below 0 of
    // Simplify3D, Slic3r 0.9). What is drawn back farther is brought back by macros that the file does not show.
    constexpr double kMostOwed = 10;  // mm
    if (!unloaded && (drawn_back < kRounding || drawn_back > kMostOwed)) drawn_back = 0;
    const double fetched = std::min(drawn_back, mm);
    if (unloaded && !in_place && fetched > 0 && !settings_.shared_nozzle)
        warn(
            "E has fallen back by more than 25 mm: what follows brings the filament back, and lays nothing until "
            "then; is a G92 E0 missing?");
    drawn_back -= fetched;
    unloaded = unloaded && drawn_back > 0;
    return drive * (1 - fetched / mm);
}

double Machine::freshOf(double drive) const {
    const double mm = volumetric_ ? drive / filamentArea() : drive;
    const double drawn_back = drawn_back_[settings_.shared_nozzle ? 0 : tool_];
    return mm > drawn_back ? drive * (1 - drawn_back / mm) : 0;
}

void Machine::loaded() {
    const std::size_t nozzle = settings_.shared_nozzle ? 0 : tool_;
    drawn_back_[nozzle] = 0;
    unloaded_[nozzle] = false;
}

bool Machine::isThread(double extrusion, double length) const {
    const double area = (volumetric_ ? extrusion : extrusion * filamentArea()) / length;
    return area >= sectionArea(kThinnestThread, 1) && area <= sectionArea(kThickestThread, 10);
}

void Machine::runStrut(const Point& target, double extrusion, double drive) {
    const std::size_t beads_before = recorder_.toolpath().beads.size();
    drive_per_extrusion_ = drive / extrusion;
    deposit(target, std::nullopt, target.z - frame_.position().z, extrusion);
    if (moves_ != nullptr) recordPath(target, std::nullopt, drive, beads_before);
    frame_.moveTo(target);
}

void Machine::recordPath(const Point& target, const std::optional<Arc>& arc, double drive, std::size_t beads_before) {
    const double filament = (volumetric_ ? drive / filamentArea() : drive) * flow_[tool_];
    const std::size_t beads = recorder_.toolpath().beads.size();
    // A copy, if there is one, comes behind the bead.
    const auto bead = beads > beads_before ? static_cast<std::uint32_t>(beads_before) : Move::kNoBead;
    moves_->move(frame_.position(), target, arc, filament, filamentArea(), feed_ * speed_factor_, bead, line_);
}

// Under G93 the time is of the whole path.
void Machine::timeArc(const Arc& arc, const Point& target, int turns) {
    if (!inverse_time_) return;
    const Point& at = frame_.position();
    const double radius = norm(at[plane_.first] - arc.center_x, at[plane_.second] - arc.center_y);
    const double plan = radius * (std::abs(arc.sweep) + turns * kFullTurn);
    const std::size_t normal = plane_.normal();
    feed_ = norm(plan, target[normal] - at[normal]) / move_seconds_;
    recorder_.setSpeed(feed_ * speed_factor_);
}

void Machine::recordTravel(const Command& command, const Point& target, int motion, double drive) {
    std::optional<Arc> arc;
    if ((motion == 2 || motion == 3) && plane_.normal() == 2) arc = arcOf(command, target, motion == 2);
    if (arc) timeArc(*arc, target, 0);
    if (arc && firmware_ == Firmware::klipper && !command.hasValue('R')) {
        const auto offset = [&](char letter) { return command.hasValue(letter) ? command.value(letter) * unit_ : 0; };
        arc->sweep = klipperSweep({frame_.position().x, frame_.position().y}, {target.x, target.y},
                                  {offset('I'), offset('J')}, motion == 2);
    }
    recordPath(target, arc, drive, recorder_.toolpath().beads.size());
}

double Machine::switchedExtrusion(double length) {
    double height = recorder_.height();
    if (!(height > 0)) height = nominal_height_ > 0 ? nominal_height_ : kSwitchedHeight;
    const double width =
        settings_.extrusion_width.value_or(settings_.nozzle_diameter.value_or(kSwitchedAspect * height));
    warn(fmt::format("M101 without E: the file doesn't say how much is extruded; beads of {:g} x {:g} mm are assumed",
                     width, height));
    const double volume = sectionArea(width, height) * length;
    return volumetric_ ? volume : volume / filamentArea();
}

void Machine::deposit(const Point& target, const std::optional<Arc>& arc, double length, double extrusion) {
    const double volume = volumetric_ ? extrusion : extrusion * filamentArea();
    const double filament = volumetric_ ? extrusion / filamentArea() : extrusion;
    count(tool_, filament);
    ++counts_.beads;
    frame_.freezePrintSpace();
    checkExtraAxes();
    const double flow = flow_[tool_];
    if (!(flow > 0)) return;
    if (flow != (flow_changes_.empty() ? 1 : flow_changes_.back().factor))
        flow_changes_.push_back({recorder_.toolpath().beads.size(), flow});
    extruded_mm3_ += volume * flow;
    lay(frame_.position(), target, arc, length, volume * flow);
    if (carriages_.copies() && !simulates_flow_) layCopy(target, arc, length, volume * flow, filament);
}

void Machine::lay(const Point& from, const Point& to, std::optional<Arc> arc, double length, double volume) {
    if (!belt_) return recorder_.add(from, to, arc, length, volume, line_);
    const Point start = belt_->place(from);
    const Point end = belt_->place(to);
    if (arc) arc = belt_->place(*arc, from.z);
    recorder_.add(start, end, arc, arc ? length : distance(start, end), volume, line_);
}

void Machine::count(std::size_t tool, double filament) {
    filament_mm_ += filament;
    std::vector<double>& by_tool = recorder_.toolpath().filament_by_tool;
    if (by_tool.size() <= tool) by_tool.resize(tool + 1);
    by_tool[tool] += filament;
}

void Machine::layCopy(const Point& target, const std::optional<Arc>& arc, double length, double volume,
                      double filament) {
    const std::size_t other = tool_ == 0 ? 1 : 0;
    count(other, filament);
    extruded_mm3_ += volume;
    Point from = frame_.position();
    Point to = target;
    from.x = carriages_.copyOf(from.x);
    to.x = carriages_.copyOf(to.x);
    recorder_.setTool(static_cast<std::uint8_t>(other));
    lay(from, to, arc ? std::optional(carriages_.copyOf(*arc)) : std::nullopt, length, volume);
    recorder_.setTool(static_cast<std::uint8_t>(tool_));
}

// Axes besides X, Y, Z and E: W lowers the bed, others turn the part or the nozzle.

void Machine::moveExtraAxes(const Command& command) {
    if (ExtraAxes::isMix(command)) {
        if (std::optional<ToolMix> mix = mixer_.setAll(command, tool_)) recorder_.changeMix(std::move(*mix), line_);
        return;
    }
    const double rise = extra_axes_.move(command, absolute_, unit_);
    if (rise == 0) return;
    Point target = frame_.position();
    target.z -= rise;
    if (rise > 0 || !(target.z <= kMaxCoordinate))
        return warn("W would move the bed into the nozzle, or further than any printer has room; it is not followed");
    warn("W lowers the bed, as on ORNL's machines: the print goes on above");
    if (moves_ != nullptr) recordPath(target, std::nullopt, 0, recorder_.toolpath().beads.size());
    frame_.lowerBed(-rise);
}

void Machine::checkExtraAxes() {
    extra_axes_.freeze();
    if (!extra_axes_.anyAway()) return;
    const std::string turned = extra_axes_.away("ABC");
    const std::string what = fmt::format("{} turn{} the part or the nozzle", turned, turned.size() == 1 ? "s" : "");
    if (!turned.empty() && !planar_)
        refuse(
            fmt::format("{}: what lies where X, Y and Z say is not the print (--planar reads it all the same)", what));
    if (!turned.empty()) warn(fmt::format("{}, which is not followed: what is read is not the print", what));
    if (const std::string beside = extra_axes_.away("UV"); !beside.empty())
        warn(fmt::format("{} not followed: beads lie where X, Y and Z say",
                         beside + (beside.size() == 1 ? " is" : " are")));
}

// M220 and M221: factors of all speeds and of the flow.

void Machine::setSpeedFactor(const Command& command) {
    if (command.has('B')) speed_backup_ = speed_factor_;
    if (command.has('R')) speed_factor_ = speed_backup_;
    if (command.hasValue('S')) {
        const double percent = command.value('S');
        if (!(percent > 0 && percent <= kMaxFactor)) return warn("M220 with a speed that no printer has; ignored");
        speed_factor_ = percent / 100;
    }
    recorder_.setSpeed(feed_ * speed_factor_);
}

void Machine::setFlow(const Command& command) {
    if (!command.hasValue('S')) return;
    const double percent = command.value('S');
    if (!(percent >= 0 && percent <= kMaxFactor)) refuse(fmt::format("M221 S{} is no flow in per cent", percent));
    if (firmware_ == Firmware::klipper) return flow_.fill(percent / 100 * all_flow_);  // one factor for all tools
    std::size_t tool = tool_;
    for (const char letter : {'T', 'D'})  // Marlin, RepRapFirmware
        if (command.hasValue(letter) && command.value(letter) >= 0 && command.value(letter) < 255)
            tool = static_cast<std::size_t>(command.value(letter));
    flow_[tool] = percent / 100 * all_flow_;
}

void Machine::setAdvance(const Command& command, char seconds, char tool) {
    if (command.hasValue(seconds))
        recorder_.advance(command.hasValue(tool) ? command.value(tool) : static_cast<double>(tool_),
                          command.value(seconds), line_);
}

void Machine::setHeatOrFan(const Command& command) {
    if (command.code == 104 || command.code == 109) {
        if (!command.hasValue('S') && !command.hasValue('R')) return;
        return recorder_.heat(command.hasValue('T') ? command.value('T') : static_cast<double>(tool_),
                              command.value(command.hasValue('S') ? 'S' : 'R'), line_);
    }
    // Fan 1 is that of the part on Bambu's machines; those behind it cool other things.
    if (command.hasValue('P') && command.value('P') >= 2) return;
    const double speed = command.code == 107 ? 0 : command.hasValue('S') ? command.value('S') : 255;
    // RepRapFirmware takes shares, too.
    recorder_.blow(firmware_ == Firmware::reprap && speed <= 1 ? 100 * speed : speed / 2.55, line_);
}

}  // namespace stratum::gcode
