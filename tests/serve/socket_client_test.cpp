#include "serve/socket_client.h"

#include "running_server.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

namespace stratum::serve {
namespace {

TEST(SocketClient, HearsAndAnswersInOrder) {
    test::RunningServer server;
    test::RawClient client = server.client();
    ASSERT_EQ(client.open(server.page), 101);
    for (int n = 0; n < 50; ++n) client.say(std::to_string(n));
    for (int n = 0; n < 50; ++n) EXPECT_EQ(client.hear().second, "heard " + std::to_string(n));
    server.recorder.last()->sendBytes({1, 2, 3});
    const auto [kind, bytes] = client.hear();
    EXPECT_EQ(kind, 2);
    EXPECT_EQ(bytes, "\1\2\3");
}

TEST(SocketClient, TellsWhoFloodsWhy) {
    Limits limits;
    limits.messages_per_second = 10;
    test::RunningServer server(limits);
    test::RawClient client = server.client();
    ASSERT_EQ(client.open(server.page), 101);
    std::string flood;
    for (int n = 0; n < 1000; ++n) flood += test::RawClient::frame("flood");
    client.send(flood);
    std::pair<int, std::string> heard = client.hear();
    while (heard.first == 1) heard = client.hear();
    EXPECT_EQ(heard.first, 8);
    EXPECT_NE(heard.second.find("too many messages"), std::string::npos) << heard.second;
}

TEST(SocketClient, EndsLongMessages) {
    Limits limits;
    limits.message_bytes = 1000;
    test::RunningServer server(limits);
    {
        test::RawClient client = server.client();
        ASSERT_EQ(client.open(server.page), 101);
        client.say(std::string(1000, 'a'));
        EXPECT_EQ(client.hear().second.size(), 1006U);
        client.say(std::string(1001, 'a'));
        const auto [kind, bytes] = client.hear();
        EXPECT_EQ(kind, 8);
        EXPECT_EQ(bytes.substr(0, 2), "\x03\xf1");  // 1009: too big
    }
    EXPECT_TRUE(server.recorder.waitFor("closed"));
}

// More than the system keeps for a socket, and nobody reads it.
TEST(SocketClient, EndsWhoDoesNotRead) {
    Limits limits;
    limits.queued_bytes = 1 << 20;
    test::RunningServer server(limits);
    test::RawClient client = server.client();
    ASSERT_EQ(client.open(server.page), 101);
    ASSERT_TRUE(server.recorder.waitFor("opened"));
    const std::shared_ptr<Client> other = server.recorder.last();
    for (int n = 0; n < 64; ++n) other->sendBytes(std::vector<std::uint8_t>(1 << 18));
    EXPECT_TRUE(server.recorder.waitFor("closed"));
    other->sendText("to nobody");
    other->close("it is over already");
}

TEST(SocketClient, AnyThreadMaySendAndClose) {
    test::RunningServer server;
    test::RawClient client = server.client();
    ASSERT_EQ(client.open(server.page), 101);
    ASSERT_TRUE(server.recorder.waitFor("opened"));
    {
        const std::shared_ptr<Client> other = server.recorder.last();
        std::vector<std::thread> threads;
        for (int n = 0; n < 4; ++n)
            threads.emplace_back([&other] {
                for (int k = 0; k < 25; ++k) other->sendText("text");
            });
        for (std::thread& thread : threads) thread.join();
        other->close("enough");
    }
    int texts = 0;
    std::pair<int, std::string> heard = client.hear();
    for (; heard.first == 1; heard = client.hear()) ++texts;
    EXPECT_EQ(heard.first, 8);
    EXPECT_NE(heard.second.find("enough"), std::string::npos);
    EXPECT_LE(texts, 100);
}

}  // namespace
}  // namespace stratum::serve
