#include "gcode/container/container.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace stratum::gcode {
namespace {

// What comes out of a pipe into which `text` went.
ByteBuffer throughPipe(const std::string& text, std::size_t most) {
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    std::thread writer([&] {
        for (std::size_t at = 0; at < text.size();) {
            const ssize_t done = ::write(ends[1], text.data() + at, text.size() - at);
            if (done <= 0) break;
            at += static_cast<std::size_t>(done);
        }
        ::close(ends[1]);
    });
    struct Finish {
        std::thread& writer;
        int end;
        ~Finish() {
            char rest[4096];
            while (::read(end, rest, sizeof rest) > 0) continue;
            writer.join();
            ::close(end);
        }
    } const finish{writer, ends[0]};
    return readAll(ends[0], "standard input", most);
}

TEST(InputBytes, APipeToItsEnd) {
    const std::string text(3000000, 'G');
    EXPECT_TRUE(throughPipe(text, text.size()).view() == text);
    EXPECT_THROW(throughPipe("", 10), InputError);
    EXPECT_THROW(throughPipe(text, text.size() - 1), InputError);
    EXPECT_THROW(readAll(-1, "standard input", 10), InputError);
}

TEST(InputBytes, AFile) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / "stratum_input_bytes.gcode";
    std::ofstream(path) << "G1 X1\n";
    const InputBytes input(path.string());
    EXPECT_EQ(input.bytes(), "G1 X1\n");
    EXPECT_EQ(input.name(), path.string());
    std::filesystem::remove(path);
    EXPECT_THROW(InputBytes("no such file"), InputError);
}

TEST(InputBytes, ANamedPipe) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / "stratum_input_bytes.pipe";
    std::filesystem::remove(path);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    EXPECT_TRUE(isStream(path.string()));
    EXPECT_TRUE(isStream("-"));
    EXPECT_FALSE(isStream("no such file"));
    EXPECT_THROW(InputBytes(path.string(), InputBytes::Streams::refuse), InputError);
    std::thread writer([&path] { std::ofstream(path) << "G1 X1\n"; });
    const InputBytes input(path.string());
    writer.join();
    EXPECT_EQ(input.bytes(), "G1 X1\n");
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace stratum::gcode
