#include "shade/integrator/checkpoint.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/analytic_prints.h"
#include "shade/integrator/render.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <string>

namespace stratum {
namespace {

namespace fs = std::filesystem;

shade::RenderOptions smallOptions(const fs::path& checkpoint) {
    shade::RenderOptions options;
    options.width = 130;
    options.height = 70;
    options.spp = 8;
    options.aovs = shade::parseAovs("normal,variance");
    options.checkpoint = checkpoint;
    options.checkpoint_interval = 0.0;
    return options;
}

shade::RenderResult rendered(const shade::RenderOptions& options, const char* brdf = "lambert:0.5,0.25,0.125",
                             const shade::Progress& progress = {}) {
    static const auto ball = test::sphere({0, 0, 0}, 1.0);
    shade::SceneOptions scene;
    scene.brdf = brdf;
    return shade::render(ball, shade::makeScene(scene, ball, options.width, options.height), options, progress);
}

bool sameBytes(const shade::RenderResult& a, const shade::RenderResult& b) {
    const auto& pa = a.film.pixels();
    const auto& pb = b.film.pixels();
    return pa.size() == pb.size() && std::memcmp(pa.data(), pb.data(), pa.size() * sizeof pa[0]) == 0 &&
           a.film.layers()[0].values == b.film.layers()[0].values &&
           a.film.layers()[1].values == b.film.layers()[1].values && a.rays == b.rays && a.mean_spp == b.mean_spp;
}

TEST(Checkpoint, AnInterruptedRenderEndsAsAnUninterruptedOne) {
    const test::ScratchFolder scratch;
    const auto whole = rendered(smallOptions({}));
    for (const int tiles : {1, 4, 9}) {
        const fs::path file = scratch / fmt::format("c{}", tiles);
        int finished = 0;
        EXPECT_THROW(rendered(smallOptions(file), "lambert:0.5,0.25,0.125",
                              [&](std::uint64_t, std::uint64_t) {
                                  if (finished++ == tiles) throw std::runtime_error("power cut");
                              }),
                     std::runtime_error);
        std::uint64_t first = 0;
        const auto resumed = rendered(smallOptions(file), "lambert:0.5,0.25,0.125",
                                      [&](std::uint64_t done, std::uint64_t) { first = first == 0 ? done : first; });
        EXPECT_TRUE(sameBytes(whole, resumed)) << tiles;
        EXPECT_GT(first, 1024u);  // what was finished is not done again
        // And of a finished one nothing is left to do.
        int calls = 0;
        EXPECT_TRUE(sameBytes(whole, rendered(smallOptions(file), "lambert:0.5,0.25,0.125",
                                              [&](std::uint64_t, std::uint64_t) { ++calls; })));
        EXPECT_EQ(calls, 0);
    }
}

/// Not a test: what the process does that the next test kills.
TEST(Checkpoint, DISABLED_RendersUntilItIsKilled) {
    const char* file = std::getenv("STRATUM_TEST_CHECKPOINT");
    ASSERT_NE(file, nullptr);
    rendered(smallOptions(file));
}

/// Which file has the name: every checkpoint is a new one, put in the place of the last. 0: there is none.
ino_t fileAt(const fs::path& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

TEST(Checkpoint, AKilledProcessLosesNothingThatWasWritten) {
    const test::ScratchFolder scratch;
    const fs::path file = scratch / "c";
    ::setenv("STRATUM_TEST_CHECKPOINT", file.c_str(), 1);
    std::mt19937 random(3);
    const auto whole = rendered(smallOptions({}));
    int killed = 0;
    // A busy machine may be late with a kill, and find the render at its end: then more of them.
    for (int run = 0; killed < 6 && run < 60; ++run) {
        const ino_t before = fileAt(file);
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {  // a process of its own: threads don't survive a fork
            const int silence = ::open("/dev/null", O_WRONLY);
            ::dup2(silence, STDOUT_FILENO);
            ::execl("/proc/self/exe", "test_shade", "--gtest_also_run_disabled_tests",
                    "--gtest_filter=Checkpoint.DISABLED_RendersUntilItIsKilled", nullptr);
            ::_exit(1);
        }
        int status = 0;
        pid_t ended = 0;
        // Killed when there is a new checkpoint, or some time after that: while the next one is written.
        while ((ended = ::waitpid(child, &status, WNOHANG)) == 0 && fileAt(file) == before) ::usleep(20);
        if (run % 2 == 0) ::usleep(static_cast<useconds_t>(random() % 3000));
        if (ended == 0) {
            ::kill(child, SIGKILL);
            ASSERT_EQ(::waitpid(child, &status, 0), child);
        }
        killed += WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
        ASSERT_NE(fileAt(file), 0u);
        if (WIFEXITED(status)) {  // it had the time to end
            EXPECT_TRUE(sameBytes(whole, rendered(smallOptions(file))));
            fs::remove(file);
        }
    }
    EXPECT_GE(killed, 3);
    EXPECT_TRUE(sameBytes(whole, rendered(smallOptions(file))));
    ::unsetenv("STRATUM_TEST_CHECKPOINT");
}

TEST(Checkpoint, OfAnotherPictureIsRefused) {
    const test::ScratchFolder scratch;
    const fs::path file = scratch / "c";
    rendered(smallOptions(file));
    const auto refused = [&](auto change, const char* brdf = "lambert:0.5,0.25,0.125") {
        shade::RenderOptions options = smallOptions(file);
        change(options);
        EXPECT_TRUE(test::refuses<InputError>("another picture", [&] { rendered(options, brdf); }));
    };
    refused([](auto& o) { o.seed = 1; });
    refused([](auto& o) { o.spp = 16; });
    refused([](auto& o) { o.width = 129; });
    refused([](auto& o) { o.aovs.pop_back(); });
    refused([](auto& o) { o.integrator.bounces = 2; });
    refused([](auto&) {}, "lambert:0.5,0.25,0.126");
}

TEST(Checkpoint, DamageIsNoticed) {
    const test::ScratchFolder scratch;
    const fs::path file = scratch / "c";
    rendered(smallOptions(file));
    const std::string good = test::bytesOf(file);
    const auto refused = [&](const std::string& bytes) {
        std::ofstream(file, std::ios::binary) << bytes;
        EXPECT_THROW(rendered(smallOptions(file)), InputError);
    };
    refused(good.substr(0, good.size() - 1));
    refused(good.substr(0, 20));
    refused("PNG");
    std::string flipped = good;
    flipped[good.size() / 2] ^= 1;
    refused(flipped);
    shade::RenderOptions options = smallOptions(scratch / "no" / "folder");
    EXPECT_THROW(rendered(options), OutputError);
    options = smallOptions(scratch / "c");
    options.seconds = 1.0;
    EXPECT_THROW(rendered(options), UsageError);
}

}  // namespace
}  // namespace stratum
