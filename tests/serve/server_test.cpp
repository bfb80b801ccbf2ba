#include "serve/server.h"

#include "base/error.h"
#include "running_server.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <ctime>
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
