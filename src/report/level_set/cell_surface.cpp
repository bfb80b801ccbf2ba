#include "report/level_set/cell_surface.h"

#include <cmath>
#include <cstddef>

namespace stratum::report {
namespace {

// Edge 4 a + b runs along axis a; b has the two other coordinates, the lower axis first.
constexpr int kEdges = 12;

constexpr int cornerOf(int edge, int end) {
    const int axis = edge / 4;
    const int low = axis == 0 ? 1 : 0;
    const int high = axis == 2 ? 1 : 2;
    return (edge & 1) << low | (edge >> 1 & 1) << high | end << axis;
}

constexpr int edgeBetween(int a, int b) {
    for (int edge = 0; edge < kEdges; ++edge)
        if ((cornerOf(edge, 0) == a && cornerOf(edge, 1) == b) || (cornerOf(edge, 0) == b && cornerOf(edge, 1) == a))
            return edge;
    return -1;
}

// Corners of each face, counter-clockwise as seen from outside the cell.
constexpr int kCellFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

constexpr CellPolygons polygonsOf(unsigned inside) {
    // A crossing goes in on one of the two faces of its edge, and out on the other.
    int next[kEdges] = {};
    for (int& edge : next) edge = -1;
    for (const auto& face : kCellFaces)
        for (int n = 0; n < 4; ++n) {
            if ((inside >> face[n] & 1U) != 0 || (inside >> face[(n + 1) % 4] & 1U) == 0) continue;
            int last = (n + 1) % 4;
            while ((inside >> face[(last + 1) % 4] & 1U) != 0) last = (last + 1) % 4;
            next[edgeBetween(face[n], face[(n + 1) % 4])] = edgeBetween(face[last], face[(last + 1) % 4]);
        }
    CellPolygons polygons;
    std::size_t at = 0;
    for (int edge = 0; edge < kEdges; ++edge) {
        if (next[edge] < 0) continue;
        const std::size_t length = at++;
        for (int e = edge; next[e] >= 0;) {
            polygons.edges[at++] = static_cast<std::uint8_t>(e);
            const int following = next[e];
            next[e] = -1;
            e = following;
        }
        polygons.edges[length] = static_cast<std::uint8_t>(at - length - 1);
    }
    return polygons;
}

constexpr std::array<CellPolygons, 256> kPolygons = [] {
    std::array<CellPolygons, 256> table;
    for (unsigned inside = 0; inside < 256; ++inside) table[inside] = polygonsOf(inside);
    return table;
}();

// Where each edge begins, and along which axis it runs.
struct EdgePlace {
    std::uint8_t low, high, axis;
    float x, y, z;
};
constexpr std::array<EdgePlace, kEdges> kPlaces = [] {
    std::array<EdgePlace, kEdges> places{};
    for (int edge = 0; edge < kEdges; ++edge) {
        const int a = cornerOf(edge, 0);
        places[static_cast<std::size_t>(edge)] = {
            static_cast<std::uint8_t>(a),        static_cast<std::uint8_t>(cornerOf(edge, 1)),
            static_cast<std::uint8_t>(edge / 4), static_cast<float>(a & 1),
            static_cast<float>(a >> 1 & 1),      static_cast<float>(a >> 2)};
    }
    return places;
}();

struct CellVector {
    float x, y, z;
};
CellVector operator-(const CellVector& a, const CellVector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
float lengthOfCross(const CellVector& a, const CellVector& b) {
    const CellVector c{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return std::sqrt(c.x * c.x + c.y * c.y + c.z * c.z);
}

CellVector crossing(std::size_t edge, const float (&corners)[8]) {
    const EdgePlace& place = kPlaces[edge];
    const float t = corners[place.low] / (corners[place.low] - corners[place.high]);
    return {place.x + (place.axis == 0 ? t : 0), place.y + (place.axis == 1 ? t : 0),
            place.z + (place.axis == 2 ? t : 0)};
}

}  // namespace

const std::array<CellPolygons, 256>& cellPolygons() { return kPolygons; }

double cellSurface(const float (&corners)[8]) {
    unsigned inside = 0;
    for (unsigned n = 0; n < 8; ++n) inside |= (corners[n] < 0 ? 1U : 0U) << n;
    const CellPolygons& polygons = kPolygons[inside];
    float twice = 0;
    for (std::size_t at = 0; polygons.edges[at] != 0;) {
        const std::size_t count = polygons.edges[at++];
        CellVector points[kEdges + 1];
        CellVector middle{0, 0, 0};
        for (std::size_t n = 0; n < count; ++n) {
            points[n] = crossing(polygons.edges[at + n], corners);
            middle.x += points[n].x;
            middle.y += points[n].y;
            middle.z += points[n].z;
        }
        at += count;
        if (count == 3) {
            twice += lengthOfCross(points[1] - points[0], points[2] - points[0]);
            continue;
        }
        const float part = 1 / static_cast<float>(count);
        middle = {middle.x * part, middle.y * part, middle.z * part};
        points[count] = points[0];
        for (std::size_t n = 0; n < count; ++n) twice += lengthOfCross(points[n] - middle, points[n + 1] - middle);
    }
    return 0.5 * static_cast<double>(twice);
}

}  // namespace stratum::report
