#include "assemble/print/lazy_print.h"

#include "prints.h"

#include <gtest/gtest.h>

namespace stratum::assemble {
namespace {

TEST(LazyPrint, ShowsEarlierMoments) {
    TracingOptions options = test::coarseTracing();
    options.prints.series = 3;
    const TracedObjects objects = readTracedObjects({test::printOf("tile.gcode")}, options);
    const std::shared_ptr<LazyPrint> print = growingPrint(objects);
    ASSERT_TRUE(print);
    ASSERT_EQ(print->moments(), 3U);
    const auto beads = [&] { return print->report()["printed_beads"].get<std::size_t>(); };
    const std::size_t all = beads();
    print->show(0);
    EXPECT_LT(beads(), all);
    EXPECT_GT(beads(), 0U);
    print->show(2);
    EXPECT_EQ(beads(), all);
}

TEST(LazyPrint, TellsOfABoundOnItsBricks) {
    TracingOptions options = test::coarseTracing();
    options.brick_cache = 100'000'000;
    const TracedObjects objects = readTracedObjects({test::printOf("tile.gcode")}, options);
    EXPECT_EQ(objects.prints[0]->report()["brick_cache"]["limit_bytes"], 100'000'000);
}

}  // namespace
}  // namespace stratum::assemble
