#include "assemble/print/kept_prints.h"

#include "prints.h"

#include <gtest/gtest.h>

namespace stratum::assemble {
namespace {

TEST(KeptPrints, AProgramIsReadOnceUnlessTimesAreMissing) {
    KeptPrints kept;
    TracingOptions options = test::coarseTracing();
    options.prints.kept = &kept;
    int read = 0;
    options.events.begin = [&read](std::string_view step, bool) { read += step == "reading" ? 1 : 0; };
    const ObjectOptions tile = test::printOf("tile.gcode");
    (void)readTracedObjects({tile}, options);
    options.prints.print.layers = "1:3";
    (void)readTracedObjects({tile}, options);
    EXPECT_EQ(read, 1);
    options.color_by = "time";
    (void)readTracedObjects({tile}, options);
    EXPECT_EQ(read, 2);
    options.color_by.clear();
    options.prints.print.layers.clear();
    (void)readTracedObjects({tile}, options);
    EXPECT_EQ(read, 2);
    kept.forget();
    (void)readTracedObjects({tile}, options);
    EXPECT_EQ(read, 3);
}

TEST(KeptPrints, ASelectionIsKeptWhileItIsUsed) {
    KeptPrints kept;
    TracingOptions options = test::coarseTracing();
    options.prints.kept = &kept;
    const ObjectOptions tile = test::printOf("tile.gcode");
    const ondemand::PrintField* field = nullptr;
    {
        const TracedObjects first = readTracedObjects({tile}, options);
        field = &first.prints.front()->finest();
        options.color_by = "feature";
        const TracedObjects second = readTracedObjects({tile}, options);
        EXPECT_EQ(&second.prints.front()->finest(), field);
        options.prints.print.layers = "2:3";
        const TracedObjects third = readTracedObjects({tile}, options);
        EXPECT_NE(&third.prints.front()->finest(), field);
        EXPECT_TRUE(kept.print(tile.vdb, options.prints, false));
    }
    EXPECT_FALSE(kept.print(tile.vdb, options.prints, false));
}

}  // namespace
}  // namespace stratum::assemble
