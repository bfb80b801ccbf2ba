#include "mechanics/inp_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "base/text.h"
#include "mechanics/element_sets.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <vector>

namespace stratum::mechanics {
namespace {

constexpr std::size_t kChunkLines = 16384;  // about a megabyte
constexpr std::size_t kChunksAtOnce = 32;

// Lines of numbers are made by all threads, a few chunks at a time, and written in order.
class Lines {
public:
    explicit Lines(FileWriter& out) : out_(out) {}

    void text(std::string_view text) { out_.text(text); }

    // line(n, buffer) appends line n.
    template <typename Line>
    void each(std::size_t count, const Line& line) {
        const std::size_t chunks = (count + kChunkLines - 1) / kChunkLines;
        std::vector<fmt::memory_buffer> made(std::min(chunks, kChunksAtOnce));
        for (std::size_t begin = 0; begin < chunks; begin += made.size()) {
            const std::size_t now = std::min(made.size(), chunks - begin);
            parallelFor(now, 1, [&](std::size_t first, std::size_t last) {
                for (std::size_t c = first; c < last; ++c) {
                    made[c].clear();
                    const std::size_t from = (begin + c) * kChunkLines;
                    for (std::size_t n = from; n < std::min(from + kChunkLines, count); ++n) line(n, made[c]);
                }
            });
            for (std::size_t c = 0; c < now; ++c) text({made[c].data(), made[c].size()});
        }
    }

    void set(const char* keyword, const NamedSet& set) {
        text(fmt::format("*{0}, {0}={1}, GENERATE\n", keyword, set.name));
        each(set.members.size(), [&set](std::size_t n, fmt::memory_buffer& buffer) {
            fmt::format_to(std::back_inserter(buffer), FMT_COMPILE("{}, {}, 1\n"), set.members[n].first + 1,
                           set.members[n].last + 1);
        });
    }

private:
    FileWriter& out_;
};

// A micrometre's thousandth is below what the solvers' single precision of coordinates shows.
double rounded(double mm) { return std::round(mm * 1e6) * 1e-6 + 0.0; }

// The few coordinates that there are along an axis, as text.
class Axis {
public:
    Axis(const std::vector<Node>& nodes, std::int32_t Node::*index, double origin, double edge) : index_(index) {
        const auto [low, high] = std::minmax_element(
            nodes.begin(), nodes.end(), [index](const Node& a, const Node& b) { return a.*index < b.*index; });
        low_ = (*low).*index;
        for (std::int32_t n = low_; n <= (*high).*index; ++n) {
            text_.push_back(fmt::format("{:.9g}", rounded(origin + n * edge)));
        }
    }
    std::string_view operator()(const Node& node) const { return text_[static_cast<std::size_t>(node.*index_ - low_)]; }

private:
    std::int32_t Node::*index_;
    std::int32_t low_ = 0;
    std::vector<std::string> text_;
};

// Those of a print on a belt, whose cubes lean as its layers do.
void writeTurnedNodes(const SolidElements& elements, const Hexahedra& mesh, const voxelize::Placement& placement,
                      Lines& out) {
    out.each(mesh.nodes.size(), [&](std::size_t n, fmt::memory_buffer& buffer) {
        const Node& node = mesh.nodes[n];
        const auto [x, y, z] =
            voxelize::worldOf({elements.origin[0] + node.i * elements.edge, elements.origin[1] + node.j * elements.edge,
                               elements.origin[2] + node.k * elements.edge},
                              placement);
        fmt::format_to(std::back_inserter(buffer), FMT_COMPILE("{}, {:.9g}, {:.9g}, {:.9g}\n"), n + 1, rounded(x),
                       rounded(y), rounded(z));
    });
}

void writeNodes(const SolidElements& elements, const Hexahedra& mesh, const InpOptions& options, Lines& out) {
    const auto axis = [&](std::int32_t Node::*index, int n) {
        return Axis(mesh.nodes, index, elements.origin[n] + options.placement.offset[n], elements.edge);
    };
    out.text("*NODE, NSET=NODES\n");
    if (options.placement.tilt != 0) return writeTurnedNodes(elements, mesh, options.placement, out);
    const Axis x = axis(&Node::i, 0);
    const Axis y = axis(&Node::j, 1);
    const Axis z = axis(&Node::k, 2);
    out.each(mesh.nodes.size(), [&](std::size_t n, fmt::memory_buffer& buffer) {
        const Node& node = mesh.nodes[n];
        fmt::format_to(std::back_inserter(buffer), FMT_COMPILE("{}, {}, {}, {}\n"), n + 1, x(node), y(node), z(node));
    });
}

void writeElements(const Hexahedra& mesh, Lines& out) {
    out.text("*ELEMENT, TYPE=C3D8I, ELSET=PART\n");
    out.each(mesh.corners.size(), [&mesh](std::size_t n, fmt::memory_buffer& buffer) {
        const auto& c = mesh.corners[n];
        fmt::format_to(std::back_inserter(buffer), FMT_COMPILE("{}, {}, {}, {}, {}, {}, {}, {}, {}\n"), n + 1, c[0] + 1,
                       c[1] + 1, c[2] + 1, c[3] + 1, c[4] + 1, c[5] + 1, c[6] + 1, c[7] + 1);
    });
}

// The local axes of a direction: along it, and across it in the plan of the layers.
std::string orientation(const BeadDirection& direction, const std::string& name, double tilt) {
    constexpr double kRadians = std::numbers::pi / 180;
    const double azimuth = direction.azimuth * kRadians;
    const double elevation = direction.elevation * kRadians;
    voxelize::Placement turned;
    turned.tilt = tilt;
    const auto along = voxelize::worldOf(
        {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)},
        turned);
    const auto across = voxelize::worldOf({-std::sin(azimuth), std::cos(azimuth), 0}, turned);
    return fmt::format("*ORIENTATION, NAME={}, SYSTEM=RECTANGULAR\n{:.7f}, {:.7f}, {:.7f}, {:.7f}, {:.7f}, {}\n", name,
                       along[0], along[1], along[2], across[0], across[1],
                       across[2] == 0 ? std::string("0.") : fmt::format("{:.7f}", across[2]));
}

std::size_t writeMaterial(const SolidElements& elements, const gcode::Toolpath& toolpath, const Elastic& elastic,
                          double tilt, Lines& out) {
    const auto& [e1, e2, e3] = elastic.young;
    const auto& [nu12, nu13, nu23] = elastic.poisson;
    const auto& [g12, g13, g23] = elastic.shear;
    out.text("*MATERIAL, NAME=PLASTIC\n");
    if (elastic.isotropic) {
        out.text(fmt::format("*ELASTIC\n{:.10g}, {:.10g}\n*SOLID SECTION, ELSET=PART, MATERIAL=PLASTIC\n", e1, nu12));
        return 0;
    }
    out.text(
        fmt::format("*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{:.10g}, {:.10g}, {:.10g}, {:.10g}, {:.10g}, {:.10g}, "
                    "{:.10g}, {:.10g}\n{:.10g}\n",
                    e1, e2, e3, nu12, nu13, nu23, g12, g13, g23));
    const auto sets = directionSets(elements, toolpath);
    for (const auto& [direction, set] : sets) {
        out.set("ELSET", set);
        out.text(orientation(direction, set.name, tilt));
        out.text(fmt::format("*SOLID SECTION, ELSET={0}, MATERIAL=PLASTIC, ORIENTATION={0}\n", set.name));
    }
    return sets.size();
}

}  // namespace

InpReport writeInp(const SolidElements& elements, const Hexahedra& mesh, const gcode::Toolpath& toolpath,
                   const InpOptions& options, const std::filesystem::path& path) {
    if (elements.list.empty())
        throw UsageError(fmt::format(
            "{}: the print holds less plastic than half an element of {:g} mm; choose a smaller --voxel-size",
            path.string(), elements.edge));
    FileWriter file(path);
    Lines out(file);
    InpReport report;
    out.text(fmt::format("** by Stratum {}: {}\n** mm, N, MPa; {} nodes, {} elements of {:g} mm\n", STRATUM_VERSION,
                         onOneLine(options.source), mesh.nodes.size(), elements.list.size(), elements.edge));
    writeNodes(elements, mesh, options, out);
    writeElements(mesh, out);
    const std::vector<NamedSet> of_elements = elementSets(elements, toolpath);
    for (const NamedSet& set : of_elements) out.set("ELSET", set);
    const std::vector<NamedSet> of_nodes = nodeSets(elements, mesh, toolpath);
    for (const NamedSet& set : of_nodes) out.set("NSET", set);
    report.element_sets = of_elements.size();
    report.node_sets = of_nodes.size();
    if (options.elastic)
        report.directions = writeMaterial(elements, toolpath, *options.elastic, options.placement.tilt, out);
    file.commit();
    return report;
}

}  // namespace stratum::mechanics
