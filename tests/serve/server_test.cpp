#include "serve/server.h"

#include "base/error.h"
#include "running_server.h"
#include "scratch_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace stratum::serve {
namespace {

using std::chrono::steady_clock;

double cpuSeconds() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TEST(Server, ServesThePageToWhoHasTheToken) {
    const test::RunningServer server;
    const test::PageAddress& page = server.page;
    EXPECT_EQ(server.client().get(page, page.path), 200);
    EXPECT_EQ(server.client().get(page, page.path + "main.js"), 200);
    EXPECT_EQ(server.client().get(page, page.path + "other.js"), 404);
    EXPECT_EQ(server.client().get(page, page.path, "Content-Length: 9\r\n\r\n123456789", "POST"), 413);
    EXPECT_EQ(server.client().get(page, page.path, "", "DELETE"), 405);
    EXPECT_EQ(server.client().get(page, "/"), 403);
    EXPECT_EQ(server.client().get(page, page.path + "socket"), 426);  // no web socket
    test::PageAddress stranger = page;
    stranger.host = "evil.example";
    EXPECT_EQ(server.client().get(stranger, page.path), 403);
    // A second one, of which a proxy may have seen the other.
    test::RawClient two = server.client();
    two.send("GET " + page.path + " HTTP/1.1\r\nHost: " + page.host + "\r\nHost: evil.example\r\n\r\n");
    EXPECT_NE(two.readUntil("\r\n").find(" 400 "), std::string::npos);
}

TEST(Server, AConnectionAsksAgain) {
    const test::RunningServer server;
    test::RawClient client = server.client();
    for (int n = 0; n < 3; ++n) {
        client.send("GET " + server.page.path + " HTTP/1.1\r\nHost: " + server.page.host + "\r\n\r\n");
        EXPECT_NE(client.readUntil("page").find("200 OK"), std::string::npos);
    }
}

TEST(Server, FurtherNamesAreThoseOfAProxy) {
    ServerOptions options;
    options.hosts = {"prints.example"};
    const test::RunningServer server(options);
    test::PageAddress behind = server.page;
    behind.host = "prints.example";
    EXPECT_EQ(server.client().get(behind, server.page.path), 200);
    EXPECT_EQ(server.client().open(behind), 101);
}

// They would have their 20 seconds, and the page none of them.
TEST(Server, IdleConnectionsMakeRoom) {
    Limits limits;
    limits.connections = 4;
    const test::RunningServer server(limits);
    std::vector<test::RawClient> idle;
    for (int n = 0; n < 12; ++n) idle.push_back(server.client());
    const auto begin = steady_clock::now();
    EXPECT_EQ(server.client().get(server.page, server.page.path), 200);
    EXPECT_LT(steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(Server, RefusesMorePagesThanItHasPlaces) {
    Limits limits;
    limits.clients = 2;
    test::RunningServer server(limits);
    test::RawClient one = server.client();
    test::RawClient two = server.client();
    EXPECT_EQ(one.open(server.page), 101);
    EXPECT_EQ(two.open(server.page), 101);
    EXPECT_EQ(server.client().open(server.page), 503);
    { const test::RawClient gone = std::move(two); }
    EXPECT_TRUE(server.recorder.waitFor("closed"));
    EXPECT_EQ(server.client().open(server.page), 101);
}

// Without descriptors accept() fails at once, again and again.
TEST(Server, WaitsWhileThereAreNoDescriptors) {
    const test::RunningServer server;
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
    test::RawClient client;  // its descriptor is there before they run out
    rlimit few = before;
    few.rlim_cur = std::min<rlim_t>(before.rlim_cur, 256);
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
    std::vector<int> taken;
    for (int file = ::open("/dev/null", O_RDONLY); file >= 0; file = ::open("/dev/null", O_RDONLY))
        taken.push_back(file);
    client.connect(server.page.port);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const double begin = cpuSeconds();
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    const double used = cpuSeconds() - begin;
    for (const int file : taken) ::close(file);
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    EXPECT_LT(used, 0.3);
    EXPECT_EQ(client.get(server.page, server.page.path), 200);
}

TEST(Server, RefusesPlacesThatCannotBeHad) {
    test::Recorder handler;
    ServerOptions options;
    options.address = "localhost";
    EXPECT_THROW(Server(options, {}, handler), UsageError);
    const test::RunningServer other;
    options.address = "127.0.0.1";
    options.port = other.page.port;
    EXPECT_THROW(Server(options, {}, handler), UsageError);
}

/// A server that takes files of up to a mebibyte, and writes each to the same place.
struct TakingServer {
    test::ScratchFolder folder;
    test::RunningServer server{[] {
        Limits limits;
        limits.file_bytes = 1 << 20;
        return limits;
    }()};
    const test::PageAddress& page = server.page;
    const std::filesystem::path sent = folder / "sent";
    TakingServer() { server.recorder.folder = folder.path(); }
};

// The headers of a file that a page sends, and what comes of it.
std::string sending(const test::PageAddress& page, std::size_t length, std::string_view bytes) {
    return "Origin: http://" + page.host + "\r\nContent-Length: " + std::to_string(length) + "\r\n\r\n" +
           std::string(bytes);
}

TEST(Server, TakesFilesOfItsOwnPage) {
    TakingServer taking;
    auto& [folder, server, page, sent] = taking;
    const std::string path = page.path + "files/a%20b%2Fc%zz.gcode";
    server.recorder.folder.clear();  // takes none
    EXPECT_EQ(server.client().get(page, path, sending(page, 5, "hello"), "PUT"), 400);
    server.recorder.folder = folder.path();
    const std::string bytes(300000, 'x');
    test::RawClient client = server.client();
    client.send("PUT " + path + " HTTP/1.1\r\nHost: " + page.host + "\r\n" + sending(page, bytes.size(), bytes));
    EXPECT_NE(client.readUntil("is there").find("200 OK"), std::string::npos);
    EXPECT_TRUE(server.recorder.waitFor("incoming a b/c%zz.gcode"));
    EXPECT_EQ(test::bytesOf(sent), bytes);
    // The connection goes on; what is there is not written over.
    client.send("PUT " + path + " HTTP/1.1\r\nHost: " + page.host + "\r\n" + sending(page, 5, "hello"));
    EXPECT_NE(client.readUntil("\r\n").find(" 507 "), std::string::npos);
    EXPECT_EQ(test::bytesOf(sent), bytes);
}

TEST(Server, RefusesFilesOfOthers) {
    TakingServer taking;
    auto& [folder, server, page, sent] = taking;
    const std::string path = page.path + "files/part.gcode";
    EXPECT_EQ(server.client().get(page, path, "Content-Length: 5\r\n\r\nhello", "PUT"), 403);
    EXPECT_EQ(server.client().get(page, path, "Origin: http://evil.example\r\nContent-Length: 5\r\n\r\nhello", "PUT"),
              403);
    EXPECT_EQ(server.client().get(page, "/files/part.gcode", sending(page, 5, "hello"), "PUT"), 403);
    EXPECT_EQ(server.client().get(page, path, sending(page, 2 << 20, ""), "PUT"), 413);
    EXPECT_EQ(server.client().get(page, path, sending(page, 5, "hello"), "POST"), 413);
    EXPECT_FALSE(std::filesystem::exists(sent));
    // Without a length it is known when too much has come.
    const std::string chunk = "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
    std::string chunks = "Origin: http://" + page.host + "\r\nTransfer-Encoding: chunked\r\n\r\n";
    for (int n = 0; n < 20; ++n) chunks += chunk;
    test::RawClient client = server.client();
    client.send("PUT " + path + " HTTP/1.1\r\nHost: " + page.host + "\r\n" + chunks);
    EXPECT_NE(client.readUntil("\r\n").find(" 413 "), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(sent));
}

TEST(Server, KeepsNothingOfAFileThatIsCutShort) {
    TakingServer taking;
    auto& [folder, server, page, sent] = taking;
    const std::string head = "PUT " + page.path + "files/part.gcode HTTP/1.1\r\nHost: " + page.host + "\r\n";
    {
        test::RawClient client = server.client();
        client.send(head + sending(page, 100, "some"));
        EXPECT_TRUE(server.recorder.waitFor("incoming part.gcode"));
        // One at a time.
        EXPECT_EQ(server.client().get(page, page.path + "files/b.gcode", sending(page, 5, "hello"), "PUT"), 503);
    }
    const auto patience = steady_clock::now() + std::chrono::seconds(20);
    while (std::filesystem::exists(sent) && steady_clock::now() < patience)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_FALSE(std::filesystem::exists(sent));
    EXPECT_EQ(server.client().get(page, page.path + "files/b.gcode", sending(page, 5, "hello"), "PUT"), 200);
    EXPECT_EQ(test::bytesOf(sent), "hello");
}

TEST(Server, KnowsWhatThisMachineAloneCanReach) {
    for (const char* local : {"127.0.0.1", "127.1.2.3", "::1"}) EXPECT_TRUE(isLoopback(local)) << local;
    for (const char* other : {"0.0.0.0", "192.168.1.2", "::", "localhost", ""})
        EXPECT_FALSE(isLoopback(other)) << other;
}

TEST(Server, EndsWithConnectionsOpen) {
    std::vector<test::RawClient> clients;
    {
        const test::RunningServer server;
        for (int n = 0; n < 8; ++n) {
            clients.push_back(server.client());
            if (n % 2 == 0) {
                EXPECT_EQ(clients.back().open(server.page), 101);
            }
        }
    }
    for (test::RawClient& client : clients) EXPECT_EQ(client.readAll(), "");
}

}  // namespace
}  // namespace stratum::serve
