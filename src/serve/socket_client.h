// One web socket of the server.
#pragma once

#include "serve/server.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>

namespace stratum::serve {

// A bucket of tokens: so many events a second in the mean, and twice as many in a burst.

class RateLimit {
public:
    using Clock = std::chrono::steady_clock;

    explicit RateLimit(double per_second) : per_second_(per_second), left_(2 * per_second) {}
    /// Whether one more event is within the limit.
    bool take(Clock::time_point now = Clock::now()) {
        const std::chrono::duration<double> since = now - last_;
        last_ = now;
        left_ = std::min(2 * per_second_, left_ + std::max(0.0, since.count()) * per_second_);
        if (left_ < 1) return false;
        left_ -= 1;
        return true;
    }

private:
    double per_second_, left_;
    Clock::time_point last_ = Clock::now();
};

using Request = boost::beast::http::request<boost::beast::http::string_body>;

class SocketClient final : public Client, public std::enable_shared_from_this<SocketClient> {
public:
    /// @param gone  called once, when it is over
    SocketClient(boost::beast::tcp_stream&& stream, Handler& handler, const Limits& limits, std::function<void()> gone);
    void start(const Request& request);

    void sendText(std::string text) override;
    void sendBytes(std::vector<std::uint8_t> bytes) override;
    void close(const std::string& why) override;

private:
    struct Message {
        bool text = false;
        std::vector<std::uint8_t> bytes;
    };
    void read();
    void queue(Message message);
    void writeNext();
    void end();

    boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
    Handler& handler_;
    const Limits& limits_;
    std::function<void()> gone_;
    boost::beast::flat_buffer buffer_;
    RateLimit rate_;
    std::deque<Message> waiting_;  // the first one is being written
    std::size_t waiting_bytes_ = 0;
    bool open_ = false, over_ = false, closing_ = false;
};

}  // namespace stratum::serve
