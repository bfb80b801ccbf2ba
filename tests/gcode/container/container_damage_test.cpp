// Every container cut off or with one bit turned at 1000 places: the same print, a clear error, or a warning that the
// print is short; never anything else.
#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/container/bgcode.h"
#include "gcode/container_samples.h"
#include "gcode/program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

namespace stratum::gcode {
namespace {

constexpr std::size_t kPlaces = 1000;

struct Outcome {
    std::size_t errors = 0;
    std::size_t warned = 0;
};

class Damage {
public:
    explicit Damage(const std::string& file, double allowed_loss_mm = 0)
        : file_(file), expected_(readProgram(file)), allowed_loss_mm_(allowed_loss_mm) {
        EXPECT_EQ(alarms(expected_), 0U) << "the whole file is said to be short: nothing would be compared";
    }

    // Reads a damaged file and fails the test on a print that is not the same and does not say so.
    void read(std::string_view damaged, std::size_t place) {
        try {
            const Toolpath toolpath = readProgram(damaged);
            if (alarms(toolpath) > 0) {
                ++outcome.warned;
            } else if (allowed_loss_mm_ == 0 || toolpath.filament_mm < expected_.filament_mm - allowed_loss_mm_) {
                EXPECT_TRUE(sample::samePrint(toolpath, expected_))
                    << "damaged at " << place << ": " << toolpath.filament_mm << " mm";
            }
        } catch (const InputError& error) {
            ++outcome.errors;
            EXPECT_TRUE(std::string_view(error.what()).starts_with("test.gcode:")) << error.what();
        }
    }

    void cut() {
        const std::size_t step = std::max<std::size_t>(1, file_.size() / kPlaces);
        // An exact copy on the heap, so that a sanitizer sees every read behind the end.
        for (std::size_t n = 1; n < file_.size(); n += step) read(std::string(file_.substr(0, n)), n);
    }

    void flip(std::size_t end) {
        const std::size_t step = std::max<std::size_t>(1, end / kPlaces);
        std::string damaged = file_;
        for (std::size_t at = 0, bit = 0; at < end; at += step, bit = (bit + 3) % 8) {
            damaged[at] = static_cast<char>(damaged[at] ^ 1 << bit);
            read(damaged, at);
            damaged[at] = file_[at];
        }
    }

    Outcome outcome;

private:
    static std::size_t alarms(const Toolpath& toolpath) {
        return warningCount(toolpath, "may be cut off") + warningCount(toolpath, "seems to be cut short");
    }

    std::string file_;
    Toolpath expected_;
    double allowed_loss_mm_;
};

std::string print() { return sample::program(60) + "; filament used [g] = 1\n"; }

void cutAndFlip(const std::string& file) {
    Damage damage(file);
    damage.cut();
    damage.flip(file.size());
    EXPECT_GT(damage.outcome.errors, kPlaces);
}

TEST(ContainerDamage, Gzip) { cutAndFlip(sample::gzip(print())); }
TEST(ContainerDamage, Ufp) { cutAndFlip(sample::ufp(print())); }
TEST(ContainerDamage, ThreeMf) { cutAndFlip(sample::zip({{"a", "b"}, {"Metadata/plate_1.gcode", print()}})); }

// Plain text has nothing to notice a turned bit by: a digit is a digit. What is read must still be a print.
void flipText(std::string text) {
    const std::size_t step = std::max<std::size_t>(1, text.size() / kPlaces);
    std::size_t places = 0;
    for (std::size_t at = 0, bit = 0; at < text.size(); at += step, bit = (bit + 3) % 8, ++places) {
        const char whole = text[at];
        text[at] = static_cast<char>(whole ^ 1 << bit);
        try {
            const Toolpath toolpath = readProgram(text);
            EXPECT_FALSE(toolpath.empty());
            EXPECT_TRUE(std::isfinite(beadVolume(toolpath))) << at;
            EXPECT_GT(beadVolume(toolpath), 0) << at;
        } catch (const InputError& error) {
            EXPECT_TRUE(std::string_view(error.what()).starts_with("test.gcode:")) << error.what();
        }
        text[at] = whole;
    }
    EXPECT_GE(places, kPlaces);
}

// A cut is named with the last layer, unless nothing is lost but comments.
void cutText(std::string_view text) {
    const Toolpath whole = readProgram(text);
    const std::size_t step = std::max<std::size_t>(1, text.size() / kPlaces);
    std::size_t named = 0;
    for (std::size_t n = 1; n < text.size(); n += step) {
        try {
            const Toolpath toolpath = readProgram(std::string(text.substr(0, n)));
            const std::uint32_t last = toolpath.runOf(toolpath.beads.back()).layer;
            const std::string layer = "its last layer is " + std::to_string(last) + ", at z = ";
            if (warningCount(toolpath, layer) == 1)
                ++named;
            else
                EXPECT_TRUE(sample::samePrint(toolpath, whole)) << "cut at " << n;
        } catch (const InputError& error) {
            EXPECT_TRUE(std::string_view(error.what()).starts_with("test.gcode:")) << error.what();
        }
    }
    EXPECT_GT(named, kPlaces * 8 / 10);
}

TEST(ContainerDamage, Text) {
    cutText(print());
    flipText(print());
}

TEST(ContainerDamage, TheCorpusText) {
    STRATUM_NEEDS_CORPUS(path, "gcode/preprocess_cancellation-slic3r.gcode");
    const InputFile file(path);
    cutText(file.bytes());
    flipText(std::string(file.bytes()));
}

TEST(ContainerDamage, Bgcode) {
    // What the slicer says is used, so that a file that ends with a block is seen to be short.
    const std::string used = std::to_string(readProgram(print()).filament_mm);
    const std::string metadata = sample::block(4, 0, sample::little(0, 2), "filament used [mm]=" + used + "\n");
    for (const int compression : {0, 1, 2, 3}) {
        std::string file = sample::bgcode(print(), compression, 2);
        file.insert(10, metadata);
        cutAndFlip(file);
    }
}

TEST(ContainerDamage, BgcodeCutBetweenBlocks) {
    const std::string text = print();
    const std::string used = std::to_string(readProgram(text).filament_mm);
    std::string file = sample::bgcodeHeader() +
                       sample::block(4, 0, sample::little(0, 2), "filament used [mm]=" + used + "\n") +
                       sample::block(1, 3, sample::little(0, 2), text.substr(0, text.size() / 2));
    EXPECT_EQ(warningCount(readProgram(file), "may be cut off"), 1U);
}

TEST(ContainerDamage, BgcodeWhoseProgressEndsEarly) {
    const auto file = [](const char* percent) {
        const std::string text = "M83\nG1 Z.2\nG1 X9 E1\nM73 P" + std::string(percent) + " R0\nM84\n";
        return sample::bgcodeHeader() + sample::block(1, 3, sample::little(0, 2), text);
    };
    EXPECT_EQ(warningCount(readProgram(file("99")), "M73, says 99 %"), 1U);
    EXPECT_EQ(readProgram(file("100")).warnings.size(), 0U);
    EXPECT_EQ(readProgram(file("")).warnings.size(), 0U);
}

TEST(ContainerDamage, TheCorpusBgcodeCutBetweenBlocks) {
    STRATUM_NEEDS_CORPUS(path, "gcode/libbgcode-mini_cube_b.bgcode");
    const InputFile file(path);
    Damage damage(std::string(file.bytes()));
    BlockReader blocks(file.bytes(), "a");
    std::size_t cuts = 0;
    for (Block block; blocks.next(block); ++cuts) damage.read(file.bytes().substr(0, block.offset), block.offset);
    EXPECT_EQ(damage.outcome.errors + damage.outcome.warned, cuts);
    EXPECT_GT(damage.outcome.warned, 5U);
}

TEST(ContainerDamage, GxHeaderAndEnd) {
    const std::string text = print();
    const double used = readProgram(text).filament_mm;
    const std::string file = sample::gx(text, used);
    // Behind the thumbnail it is plain text, which has no way to notice a bit; nor a loss below one per cent.
    Damage damage(file, 0.011 * used);
    damage.cut();
    damage.flip(file.size() - text.size());
    EXPECT_GT(damage.outcome.warned, 0U);
}

void damageCorpusFile(const std::filesystem::path& path) {
    const InputFile file(path);
    cutAndFlip(std::string(file.bytes()));
}

TEST(ContainerDamage, TheCorpusBgcode) {
    STRATUM_NEEDS_CORPUS(path, "gcode/libbgcode-mini_cube_b.bgcode");
    damageCorpusFile(path);
}

TEST(ContainerDamage, TheCorpusUfp) {
    STRATUM_NEEDS_CORPUS(path, "gcode/gcode_metadata-cura_2ext.ufp");
    damageCorpusFile(path);
}

}  // namespace
}  // namespace stratum::gcode
