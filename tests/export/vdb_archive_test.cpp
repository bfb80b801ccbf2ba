#include "export/vdb_archive.h"

#include <gtest/gtest.h>
#include <openvdb/io/DelayedLoadMetadata.h>

#include <cstdint>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace stratum::exporter {
namespace {

// The numbers of leaves are those around which OpenVDB's memory for packed lists is rounded to a float.
TEST(LeafList, OpenVdbReadsListsOfAnyLength) {
    openvdb::initialize();
    constexpr std::size_t kFloats = std::size_t{1} << 24;
    for (const std::size_t leaves : {std::size_t{1}, std::size_t{1000}, kFloats + 1, 2 * kFloats + 35})
        for (const bool sized : {true, false}) {
            if (!sized && leaves == kFloats + 1) continue;  // as with sizes
            const LeafFormat format{sized ? std::uint32_t{openvdb::io::COMPRESS_BLOSC} : 0U, false};
            ASSERT_EQ(format.sized(), sized);
            LeafList list(format);
            list.reserve(leaves);
            const auto kindOf = [](std::size_t n) { return static_cast<std::int8_t>(n % 7); };
            const auto sizeOf = [](std::size_t n) { return static_cast<std::uint32_t>(n * 37 % 2000); };
            for (std::size_t n = 0; n < leaves; ++n) list.add({kindOf(n), sized ? sizeOf(n) : 0});
            const std::string bytes = list.bytes();
            EXPECT_LE(bytes.size(), LeafList::mostBytes(leaves));
            const auto length = static_cast<std::uint32_t>(bytes.size());
            std::istringstream in(std::string(reinterpret_cast<const char*>(&length), sizeof length) + bytes);
            openvdb::io::DelayedLoadMetadata read;
            ASSERT_NO_THROW(read.read(in)) << leaves;
            for (std::size_t n = 0; n < leaves; n += 1 + leaves / 1000) {
                ASSERT_EQ(read.getMask(n), kindOf(n)) << n << " of " << leaves;
                if (sized) {
                    ASSERT_EQ(read.getCompressedSize(n), sizeOf(n));
                }
            }
            ASSERT_EQ(read.getMask(leaves - 1), kindOf(leaves - 1));
            EXPECT_EQ(static_cast<std::size_t>(in.tellg()), sizeof length + bytes.size());
        }
}

// Sizes and kinds that nothing can be packed of: the room before the leaves is enough, and little.
TEST(LeafList, ListsOfNoiseFit) {
    openvdb::initialize();
    const LeafFormat format{openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK, false};
    std::mt19937 random(7);
    for (const std::size_t leaves : {std::size_t{1}, std::size_t{5}, std::size_t{6}, std::size_t{15}, std::size_t{16},
                                     std::size_t{49}, std::size_t{127}, std::size_t{128}, std::size_t{999},
                                     std::size_t{4096}, std::size_t{40'001}, std::size_t{300'000}}) {
        LeafList list(format);
        std::vector<PackedLeaf> all;
        for (std::size_t n = 0; n < leaves; ++n) {
            all.push_back({static_cast<std::int8_t>(random() % 7), static_cast<std::uint32_t>(random() % 65536)});
            list.add(all.back());
        }
        const std::string bytes = list.bytes();
        EXPECT_LE(bytes.size(), LeafList::mostBytes(leaves)) << leaves;
        EXPECT_LE(LeafList::mostBytes(leaves), 1024 + leaves * 25 / 8) << leaves;
        const auto length = static_cast<std::uint32_t>(bytes.size());
        std::istringstream in(std::string(reinterpret_cast<const char*>(&length), sizeof length) + bytes);
        openvdb::io::DelayedLoadMetadata read;
        ASSERT_NO_THROW(read.read(in)) << leaves;
        for (std::size_t n = 0; n < leaves; ++n) {
            ASSERT_EQ(read.getMask(n), all[n].kind) << n << " of " << leaves;
            ASSERT_EQ(read.getCompressedSize(n), all[n].size) << n << " of " << leaves;
        }
    }
}

}  // namespace
}  // namespace stratum::exporter
