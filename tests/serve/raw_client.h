// The other end of a connection to the server, byte by byte.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace stratum::test {

/// Of "http://127.0.0.1:8080/0123/".
struct PageAddress {
    explicit PageAddress(std::string_view url) {
        const std::size_t host_at = std::string_view("http://").size();
        const std::size_t path_at = url.find('/', host_at);
        host = url.substr(host_at, path_at - host_at);
        path = url.substr(path_at);
        port = static_cast<std::uint16_t>(std::stoi(host.substr(host.find(':') + 1)));
    }
    std::string host, path;
    std::uint16_t port = 0;
};

/// Waits 20 s for what it reads.
class RawClient {
public:
    RawClient() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        const timeval patience{20, 0};
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    }
    explicit RawClient(std::uint16_t port) : RawClient() { connect(port); }
    RawClient(RawClient&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
    RawClient(const RawClient&) = delete;
    RawClient& operator=(const RawClient&) = delete;
    ~RawClient() {
        if (socket_ >= 0) ::close(socket_);
    }

    void connect(std::uint16_t port) {
        sockaddr_in place{};
        place.sin_family = AF_INET;
        place.sin_port = htons(port);
        place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ASSERT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place), 0);
    }
    /// False if the other side has gone.
    bool send(std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (sent <= 0) return false;
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        }
        return true;
    }
    /// Up to `end`, or to where the other side ends.
    std::string readUntil(std::string_view end) {
        while (read_.find(end) == std::string::npos && more()) {
        }
        return take(
            std::min(read_.size(), read_.find(end) == std::string::npos ? read_.size() : read_.find(end) + end.size()));
    }
    std::string readAll() {
        while (more()) {
        }
        return take(read_.size());
    }
    std::string read(std::size_t count) {
        while (read_.size() < count && more()) {
        }
        return take(std::min(count, read_.size()));
    }

    /// The status of an answer; the rest of it is read. 0: none came.
    int get(const PageAddress& page, std::string_view path, std::string_view more = {}, std::string_view verb = "GET") {
        send(std::string(verb) + " " + std::string(path) + " HTTP/1.1\r\nHost: " + page.host +
             "\r\nConnection: close\r\n" + std::string(more) + "\r\n");
        const std::string answer = readAll();
        return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
    }

    /// The status of a web socket's handshake.
    int open(const PageAddress& page) {
        send("GET " + page.path + "socket HTTP/1.1\r\nHost: " + page.host + "\r\nOrigin: http://" + page.host +
             "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
        const std::string head = readUntil("\r\n\r\n");
        return head.size() > 12 ? std::stoi(head.substr(9, 3)) : 0;
    }
    /// A message, masked by zeros.
    bool say(std::string_view text) { return send(frame(text)); }
    static std::string frame(std::string_view text) {
        std::string bytes = "\x81";
        if (text.size() < 126) {
            bytes += static_cast<char>(0x80 | text.size());
        } else if (text.size() < 65536) {
            bytes += static_cast<char>(0xfe);
            for (const unsigned shift : {8U, 0U}) bytes += static_cast<char>(text.size() >> shift & 255);
        } else {
            bytes += static_cast<char>(0xff);
            for (unsigned shift = 64; shift > 0; shift -= 8)
                bytes += static_cast<char>(static_cast<std::uint64_t>(text.size()) >> (shift - 8) & 255);
        }
        return bytes.append(4, '\0').append(text);
    }
    /// What comes: its kind (1 text, 2 bytes, 8 the end; 0: nothing any more) and its bytes.
    std::pair<int, std::string> hear() {
        const std::string head = read(2);
        if (head.size() < 2) return {};
        std::uint64_t size = static_cast<unsigned char>(head[1]) & 127;
        const std::size_t longer = size == 126 ? 2 : size == 127 ? 8 : 0;
        if (longer > 0) {
            size = 0;
            for (const char byte : read(longer)) size = size << 8 | static_cast<unsigned char>(byte);
        }
        return {head[0] & 15, read(static_cast<std::size_t>(size))};
    }

private:
    bool more() {
        std::array<char, 65536> bytes{};
        const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
        if (got <= 0) return false;
        read_.append(bytes.data(), static_cast<std::size_t>(got));
        return true;
    }
    std::string take(std::size_t count) {
        std::string taken = read_.substr(0, count);
        read_.erase(0, count);
        return taken;
    }

    int socket_;
    std::string read_;
};

}  // namespace stratum::test
