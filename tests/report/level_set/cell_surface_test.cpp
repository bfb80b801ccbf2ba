#include "report/level_set/cell_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace stratum::report {
namespace {

TEST(CellSurface, EveryCrossingIsInOnePolygon) {
    for (unsigned inside = 0; inside < 256; ++inside) {
        unsigned crossings = 0;
        for (int a = 0; a < 8; ++a)
            for (const int axis : {1, 2, 4})
                if ((a & axis) == 0 && (inside >> a & 1U) != (inside >> (a | axis) & 1U)) ++crossings;
        std::multiset<int> met;
        const CellPolygons& polygons = cellPolygons()[inside];
        for (std::size_t at = 0; polygons.edges[at] != 0;) {
            const std::size_t count = polygons.edges[at++];
            EXPECT_GE(count, 3U) << inside;
            for (std::size_t n = 0; n < count; ++n) met.insert(polygons.edges[at++]);
        }
        EXPECT_EQ(met.size(), crossings) << inside;
        EXPECT_EQ(std::set<int>(met.begin(), met.end()).size(), crossings) << inside;
    }
}

TEST(CellSurface, OfPlanesIsExact) {
    // z = 0.3; and x + y = 1, which cuts the diagonal.
    float corners[8];
    for (int n = 0; n < 8; ++n) corners[n] = static_cast<float>(n >> 2) - 0.3F;
    EXPECT_NEAR(cellSurface(corners), 1, 1e-6);
    for (int n = 0; n < 8; ++n) corners[n] = static_cast<float>((n & 1) + (n >> 1 & 1)) - 0.5F;
    EXPECT_NEAR(cellSurface(corners), std::sqrt(0.5), 1e-6);
    // The corner that x + y + z = 0.5 cuts off: a triangle of edges sqrt(0.5).
    for (int n = 0; n < 8; ++n) corners[n] = static_cast<float>((n & 1) + (n >> 1 & 1) + (n >> 2)) - 0.5F;
    EXPECT_NEAR(cellSurface(corners), std::sqrt(3.0) / 8, 1e-6);
}

TEST(CellSurface, TwoSheetsInOneCell) {
    // Two opposite corners inside: a triangle at each.
    float corners[8];
    for (float& corner : corners) corner = 1;
    corners[0] = corners[7] = -1;
    EXPECT_NEAR(cellSurface(corners), 2 * std::sqrt(3.0) / 8, 1e-6);
}

}  // namespace
}  // namespace stratum::report
