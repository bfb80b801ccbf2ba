// Files of printers for tests: written into a folder, and read as --printer reads them.
#pragma once

#include "base/error.h"
#include "deposit/printer.h"
#include "refusal.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <string_view>

namespace stratum::deposit {

class PrinterFiles {
public:
    /// Returns the path.
    std::string write(const std::string& name, std::string_view text) const {
        const auto path = folder_.path() / name;
        std::ofstream(path, std::ios::binary) << text;
        return path.string();
    }

    gcode::PrinterLimits read(std::string_view text) const {
        gcode::ReadOptions options;
        usePrinter(write("printer", text), options);
        if (!options.printer) throw std::runtime_error("no limits were read");
        return *options.printer;
    }

    /// What the InputError says; empty if there is none.
    std::string refusal(std::string_view text) const {
        return test::messageOf<InputError>([&] { read(text); });
    }

private:
    test::ScratchFolder folder_;
};

/// The end of where a limit is from: "printer:3".
inline std::string placeOf(const gcode::PrinterLimits& printer, gcode::Limit limit) {
    const std::string& place = printer.origins[limit].place;
    return place.substr(place.rfind('/') + 1);
}

inline testing::AssertionResult says(const std::string& message, std::string_view part) {
    if (message.find(part) != std::string::npos && message.find('\n') == std::string::npos)
        return testing::AssertionSuccess();
    return testing::AssertionFailure() << "'" << message << "' is no line with '" << part << "'";
}

}  // namespace stratum::deposit
