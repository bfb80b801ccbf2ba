#include "serve/socket_client.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include <chrono>
#include <utility>

namespace stratum::serve {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

SocketClient::SocketClient(beast::tcp_stream&& stream, Handler& handler, const Limits& limits,
                           std::function<void()> gone)
    : stream_(std::move(stream)),
      handler_(handler),
      limits_(limits),
      gone_(std::move(gone)),
      rate_(limits.messages_per_second) {}

void SocketClient::start(const Request& request) {
    beast::get_lowest_layer(stream_).expires_never();
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.idle_timeout = std::chrono::seconds(60);
    timeout.keep_alive_pings = true;  // who doesn't answer is gone
    stream_.set_option(timeout);
    stream_.read_message_max(limits_.message_bytes);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
        if (error) return self->end();
        self->open_ = true;
        self->handler_.opened(self);
        self->read();
    });
}

void SocketClient::read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (error) return self->end();
        if (!self->rate_.take()) {
            return self->close("too many messages");  // and reads no more
        }
        const auto bytes = self->buffer_.cdata();
        if (self->stream_.got_text())
            self->handler_.received(self, {static_cast<const char*>(bytes.data()), bytes.size()});
        self->buffer_.consume(self->buffer_.size());
        self->read();
    });
}

void SocketClient::sendText(std::string text) { queue({true, {text.begin(), text.end()}}); }

void SocketClient::sendBytes(std::vector<std::uint8_t> bytes) { queue({false, std::move(bytes)}); }

void SocketClient::queue(Message message) {
    boost::asio::post(stream_.get_executor(), [self = shared_from_this(), message = std::move(message)]() mutable {
        if (!self->open_ || self->closing_) return;
        self->waiting_bytes_ += message.bytes.size();
        self->waiting_.push_back(std::move(message));
        // Who does not read what it has asked for is not waited for.
        if (self->waiting_bytes_ > self->limits_.queued_bytes) return self->end();
        if (self->waiting_.size() == 1) self->writeNext();
    });
}

void SocketClient::writeNext() {
    const Message& next = waiting_.front();
    stream_.text(next.text);
    stream_.async_write(boost::asio::buffer(next.bytes),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                            if (error) return self->end();
                            self->waiting_bytes_ -= self->waiting_.front().bytes.size();
                            self->waiting_.pop_front();
                            if (!self->waiting_.empty() && !self->over_) self->writeNext();
                        });
}

void SocketClient::close(const std::string& why) {
    boost::asio::post(stream_.get_executor(), [self = shared_from_this(), why] {
        if (!self->open_ || self->closing_) return;
        self->closing_ = true;
        self->stream_.async_close({websocket::close_code::policy_error, why},
                                  [self](beast::error_code) { self->end(); });
    });
}

void SocketClient::end() {
    if (over_) return;
    over_ = true;
    if (open_) handler_.closed(shared_from_this());
    open_ = false;
    beast::get_lowest_layer(stream_).close();
    gone_();
}

}  // namespace stratum::serve
