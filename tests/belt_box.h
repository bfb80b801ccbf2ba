// A box that a belt printer lays, from where its lines are in the world; and the distance to them there.
//
// World: x across the belt, y along it, z up from it. The gantry leans by an angle a towards +y: a nozzle at the
// program's (x, y, Z) is at (x, y cos a - Z, y sin a), since y counts up the gantry and Z is how far the belt has gone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace stratum::test {

struct BeltBox {
    double degrees = 45;
    double layer = 0.25, width = 0.5;                   ///< mm, of the lines
    double x0 = 3, x1 = 13, y0 = -12, y1 = -6, z1 = 5;  ///< mm, what nozzles reach in the world, from the belt up

    double angle() const { return degrees * std::numbers::pi / 180; }

    /// A nozzle's line along x, in the world.
    struct Line {
        double y, z;
    };

    /// Lines by layer, each layer in one plane of the gantry.
    std::vector<std::vector<Line>> layers() const {
        const double cosine = std::cos(angle());
        const double sine = std::sin(angle());
        std::vector<std::vector<Line>> all;
        const double step = layer / sine;  // of the belt
        for (double z = -y1; z <= z1 * cosine / sine - y0 + 1e-9; z += step) {
            std::vector<Line> lines;
            for (double up = 0; up * sine <= z1 + 1e-9; up += width)
                if (const double y = up * cosine - z; y >= y0 - 1e-9 && y <= y1 + 1e-9) lines.push_back({y, up * sine});
            if (!lines.empty()) all.push_back(std::move(lines));
        }
        return all;
    }

    /// By y = H / sin a and Z = H / tan a - Y of a place at height H and Y along the belt.
    std::string program() const {
        const double sine = std::sin(angle());
        const double cosine = std::cos(angle());
        const double section = layer * (width - layer) + std::numbers::pi / 4 * layer * layer;
        const double e = section * (x1 - x0) / (std::numbers::pi / 4 * 1.75 * 1.75);
        std::string text = fmt::format(";Layer height: {}\nM83\nG1 X0 Y0 Z0 F6000\n", layer);
        int n = 0;
        for (const auto& lines : layers()) {
            text += fmt::format(";LAYER:{}\n;HEIGHT:{}\nG0 Z{:.9f}\n", n++, layer,
                                lines.front().z * cosine / sine - lines.front().y);
            for (const Line& line : lines)
                text += fmt::format("G0 X{} Y{:.9f}\nG1 X{} E{:.9f} F1200\n", x0, line.z / sine, x1, e);
        }
        return text;
    }

    /// Signed distance to the lines in the world, exact outside: a disc in the leaning plane, swept along the line and
    /// by a ball, half a layer behind the nozzle.
    double distance(double x, double y, double z) const {
        const std::array<double, 2> up{std::cos(angle()), std::sin(angle())};       // of y, z: up the gantry
        const std::array<double, 2> across{-std::sin(angle()), std::cos(angle())};  // across the layers, as they grow
        double least = 1e300;
        for (const auto& lines : layers())
            for (const Line& line : lines) {
                const double ly = y - (line.y - 0.5 * layer * across[0]);
                const double lz = z - (line.z - 0.5 * layer * across[1]);
                const double beyond = x - std::clamp(x, x0, x1);
                const double plan = std::hypot(beyond, ly * up[0] + lz * up[1]) - 0.5 * (width - layer);
                least = std::min(least, std::hypot(std::max(plan, 0.0), ly * across[0] + lz * across[1]) - 0.5 * layer);
            }
        return least;
    }

    /// Box of the lines in the world, by the outermost points of their sections.
    std::array<double, 6> box() const {
        std::array<double, 6> box{x0 - 0.5 * width, 1e300, 1e300, x1 + 0.5 * width, -1e300, -1e300};
        const double cosine = std::cos(angle());
        const double sine = std::sin(angle());
        const double y_reach = 0.5 * (width - layer) * cosine + 0.5 * layer;
        const double z_reach = 0.5 * (width - layer) * sine + 0.5 * layer;
        for (const auto& lines : layers())
            for (const Line& line : lines) {
                const double y = line.y + 0.5 * layer * sine;
                const double z = line.z - 0.5 * layer * cosine;
                box[1] = std::min(box[1], y - y_reach);
                box[2] = std::min(box[2], z - z_reach);
                box[4] = std::max(box[4], y + y_reach);
                box[5] = std::max(box[5], z + z_reach);
            }
        return box;
    }
};

}  // namespace stratum::test
