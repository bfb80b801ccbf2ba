#include "base/input_file.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

namespace stratum {
namespace {

void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

// More than is read at once when a file is opened.
std::string longText() {
    std::string text;
    while (text.size() < 3000000) text += "G1 X" + std::to_string(text.size()) + "\n";
    return text;
}

void expectChanged(const std::function<void()>& read) {
    EXPECT_TRUE(test::refuses<InputError>("changed while it was read", [&] { read(); }));
}

TEST(InputFile, GivesTheBytes) {
    const test::ScratchFolder folder;
    const auto path = folder / "input.bin";
    writeBytes(path, std::string("G1 X1\0\r\n", 8));
    const InputFile file(path);
    EXPECT_EQ(file.bytes(), std::string_view("G1 X1\0\r\n", 8));
    EXPECT_EQ(file.first(2), "G1");
    EXPECT_EQ(file.first(100).size(), 8U);
}

TEST(InputFile, ReadsThePartsThatAreAskedFor) {
    const test::ScratchFolder folder;
    const auto path = folder / "input.bin";
    const std::string text = longText();
    writeBytes(path, text);
    InputFile opened(path);
    const InputFile file(std::move(opened));
    EXPECT_EQ(file.size(), text.size());
    file.load(1500000, 300000);
    EXPECT_EQ(file.unread().substr(1500000, 300000), text.substr(1500000, 300000));
    EXPECT_EQ(file.unread().substr(2900000, 10), std::string(10, '\0'));
    EXPECT_EQ(file.first(5000), text.substr(0, 5000));
    EXPECT_TRUE(file.bytes() == text);
}

TEST(InputFile, AFileThatChangesIsAnError) {
    const test::ScratchFolder folder;
    const auto path = folder / "input.bin";
    const std::string text = longText();
    writeBytes(path, text);
    {
        const InputFile file(path);
        file.load(0, 100);
        std::filesystem::resize_file(path, 1000000);
        EXPECT_EQ(file.first(100), text.substr(0, 100));  // what was read stays
        expectChanged([&] { file.bytes(); });
        expectChanged([&] { file.load(1500000, 10); });
        expectChanged([&] { file.load(300000, 10); });
    }
    writeBytes(path, text);
    const InputFile file(path);
    const timespec later[2] = {{1900000000, 0}, {1900000000, 5}};
    writeBytes(path, std::string(text.size(), 'x'));  // as long as before
    ASSERT_EQ(::utimensat(AT_FDCWD, path.c_str(), later, 0), 0);
    expectChanged([&] { file.bytes(); });
}

TEST(InputFile, AFileThatIsReplacedIsReadToItsEnd) {
    const test::ScratchFolder folder;
    const auto path = folder / "input.bin";
    const std::string text = longText();
    writeBytes(path, text);
    const InputFile file(path);
    writeBytes(folder / "other.bin", "other");
    std::filesystem::rename(folder / "other.bin", path);
    EXPECT_TRUE(file.bytes() == text);
}

TEST(InputFile, RefusesMissingEmptyFolderAndPipe) {
    const test::ScratchFolder folder;
    EXPECT_THROW(InputFile("/nonexistent/file.gcode"), InputError);
    EXPECT_THROW(InputFile(folder.path()), InputError);
    const auto path = folder / "empty.gcode";
    std::ofstream(path).close();
    EXPECT_THROW(InputFile{path}, InputError);
    const auto pipe = folder / "pipe.gcode";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THROW(InputFile{pipe}, InputError);  // without waiting for a writer
}

}  // namespace
}  // namespace stratum
