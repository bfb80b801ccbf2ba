#include "base/mapped_file.h"

#include "base/error.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace stratum {
namespace {

TEST(MappedFile, GivesTheBytes) {
    const test::ScratchFolder folder;
    const auto path = folder / "mapped.bin";
    std::ofstream(path, std::ios::binary) << std::string("G1 X1\0\r\n", 8);
    const MappedFile file(path);
    EXPECT_EQ(file.bytes(), std::string_view("G1 X1\0\r\n", 8));
}

TEST(MappedFile, RefusesMissingEmptyAndFolder) {
    const test::ScratchFolder folder;
    EXPECT_THROW(MappedFile("/nonexistent/file.gcode"), InputError);
    EXPECT_THROW(MappedFile(folder.path()), InputError);
    const auto path = folder / "empty.gcode";
    std::ofstream(path).close();
    EXPECT_THROW(MappedFile{path}, InputError);
}

// "sr" among the kernel's flags of a mapping: read ahead far, drop what is behind.
bool readsAhead(const MappedFile& file) {
    std::ifstream maps("/proc/self/smaps");
    bool ours = false;
    for (std::string line; std::getline(maps, line);) {
        if (line.find(file.path().string()) != std::string::npos) ours = true;
        if (ours && line.starts_with("VmFlags:")) return line.find(" sr") != std::string::npos;
    }
    return false;
}

TEST(MappedFile, ReadsAheadOnlyWhereAsked) {
    const test::ScratchFolder folder;
    const auto path = folder / "mapped.bin";
    std::ofstream(path, std::ios::binary) << std::string(100000, 'x');
    EXPECT_FALSE(readsAhead(MappedFile(path)));
    if (!readsAhead(MappedFile(path, Access::sequential))) GTEST_SKIP() << "the system shows no flags of mappings";
}

TEST(Sha256, KnownAnswers) {
    // FIPS 180-2, appendix B.1, and the empty message.
    EXPECT_EQ(sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

}  // namespace
}  // namespace stratum
