#include "terminal_events.h"

#include "command_line.h"
#include "progress.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

namespace stratum::tools {

assemble::ReadEvents terminalEvents(bool quiet, const std::string& tool) {
    assemble::ReadEvents events;
    events.warning = [quiet, tool](const assemble::Warning& warning) {
        if (!quiet || warning.kind == assemble::Warning::Kind::narrow_band)
            tellError(fmt::format("{}: {}\n", tool, warning.text));
    };
    if (!showsProgress(quiet)) return events;
    struct Line {
        std::optional<ProgressBar> bar;
        std::optional<ProgressNote> note;
    };
    const auto line = std::make_shared<Line>();
    events.begin = [line](std::string_view step, bool measured) {
        if (measured)
            line->bar.emplace(std::string(step), false);
        else
            line->note.emplace(std::string(step), false);
    };
    events.fraction = [line](double done) {
        if (line->bar) line->bar->show(done);
    };
    events.end = [line] {
        line->bar.reset();
        line->note.reset();
    };
    return events;
}

}  // namespace stratum::tools
