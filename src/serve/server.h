// A small web server for one page and its web sockets, meant for the machine that it runs on.
#pragma once

#include "serve/access.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::serve {

/// A file of the page; it lies in memory, and no other can be asked for.
struct PageFile {
    std::string_view path;  ///< below "/TOKEN/"; empty: the page itself
    std::string_view type;  ///< its media type
    std::string_view bytes;
};

/// Bounds on what others can make the server do.
struct Limits {
    std::size_t connections = 256;         ///< at once, of all kinds; further ones wait to be accepted
    std::size_t clients = 32;              ///< web sockets at once; further ones are refused with 503
    std::size_t message_bytes = 64 << 10;  ///< of a message to the server; a longer one ends its connection
    double messages_per_second = 250;      ///< mean of a client; more end its connection
    std::size_t queued_bytes = 64 << 20;   ///< that wait to be sent to a client; more end its connection
    std::uint64_t file_bytes = 0;          ///< of a file that a page sends; 0: none is taken
};

/// A web socket. send() and close() may be called from any thread, also after the other side has gone.
class Client {
public:
    virtual ~Client() = default;
    virtual void sendText(std::string text) = 0;
    virtual void sendBytes(std::vector<std::uint8_t> bytes) = 0;
    virtual void close(const std::string& why) = 0;
};

/// What a server is for. Called on the thread of Server::run().
class Handler {
public:
    virtual ~Handler() = default;
    virtual void opened(const std::shared_ptr<Client>& client) = 0;
    virtual void received(const std::shared_ptr<Client>& client, std::string_view text) = 0;
    virtual void closed(const std::shared_ptr<Client>& client) = 0;

    // A page sends a file: PUT /TOKEN/files/NAME. What these throw is the answer that it gets.
    /// Where the file is to be written. `name` is whatever the page says.
    virtual std::filesystem::path incoming(std::string_view name);
    /// All of it is there. Returns what the page is told.
    virtual std::string arrived(const std::filesystem::path& path);
};

struct ServerOptions {
    std::string address = "127.0.0.1";  ///< IPv4 or IPv6, to listen on
    std::uint16_t port = 0;             ///< 0: any that is free
    std::vector<std::string> hosts;     ///< further names by which it may be called
    std::string token;                  ///< empty: a random one
    Limits limits;
};

/// Whether only this machine can reach a server that listens there.
bool isLoopback(const std::string& address);

/// Listens from construction on. Throws UsageError for an address or a port that can't be had.
class Server {
public:
    Server(const ServerOptions& options, std::vector<PageFile> files, Handler& handler);
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Of the page, with the token.
    std::string url() const;
    /// Serves until stop(), or until one of SIGINT and SIGTERM.
    void run();
    /// From any thread.
    void stop();
    /// Calls `ready` on the thread of run() whenever the descriptor can be read.
    void watch(int descriptor, const std::function<void()>& ready);

private:
    struct Parts;
    const std::unique_ptr<Parts> parts_;
};

}  // namespace stratum::serve
