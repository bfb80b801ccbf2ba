#include "serve/server.h"

#include "base/error.h"
#include "base/text.h"
#include "serve/socket_client.h"

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/file_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <exception>
#include <list>
#include <optional>
#include <utility>

namespace stratum::serve {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = asio::ip::tcp;

constexpr auto kPatience = std::chrono::seconds(20);     // for a request to arrive and its answer to be taken
constexpr auto kPause = std::chrono::milliseconds(100);  // after a connection could not be taken
constexpr std::uint32_t kMostHeader = 16 << 10;          // bytes
constexpr std::string_view kSocket = "socket";           // below the token
constexpr std::string_view kFiles = "files/";            // the same
// Nothing of other hosts, no frames around the page, no sniffing of types.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr const char* kText = "text/plain; charset=utf-8";
constexpr const char* kStranger = "a page of another site";

// "%20" and the like (RFC 3986, 2.1); what is no such escape stays.
std::string decoded(std::string_view text) {
    std::string plain;
    for (std::size_t n = 0; n < text.size(); ++n) {
        const auto byte = text[n] == '%' ? parsed<unsigned>(text.substr(n + 1, 2), 16) : std::nullopt;
        plain += byte ? static_cast<char>(*byte) : text[n];
        if (byte) n += 2;
    }
    return plain;
}

class Connection;

/// What all connections share.
struct Shared {
    Shared(Handler& its_handler, const Limits& its_limits, std::vector<PageFile> its_files, Access its_access)
        : handler(its_handler), limits(its_limits), files(std::move(its_files)), access(std::move(its_access)) {}
    Handler& handler;
    const Limits limits;
    const std::vector<PageFile> files;
    const Access access;
    std::size_t connections = 0, clients = 0;
    std::list<Connection*> unanswered;  // of whom no whole request has come, the longest first
    std::function<void()> freed;        // a connection is over
    bool receives = false;              // a file: one at a time, so that what is kept is bounded
};

/// One connection, until it is answered or has become a web socket.
class Connection final : public std::enable_shared_from_this<Connection> {
public:
    Connection(tcp::socket&& socket, Shared& shared) : stream_(std::move(socket)), shared_(shared) {
        ++shared_.connections;
    }
    ~Connection() {
        shared_.unanswered.remove(this);
        if (file_) shared_.receives = false;
        if (upgraded_) return;
        --shared_.connections;
        shared_.freed();
    }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    /// Makes room for another one.
    void giveUp() {
        shared_.unanswered.remove(this);
        stream_.close();
    }

    void read() {
        shared_.unanswered.remove(this);
        shared_.unanswered.push_back(this);
        parser_.emplace();
        parser_->body_limit(shared_.limits.file_bytes);
        parser_->header_limit(kMostHeader);
        stream_.expires_after(kPatience);
        http::async_read_header(stream_, buffer_, *parser_,
                                [self = shared_from_this()](beast::error_code error, std::size_t) {
                                    if (error == http::error::body_limit || error == http::error::header_limit)
                                        return self->refuse(http::status::payload_too_large, "too large");
                                    if (error) return;  // gone, or never was HTTP
                                    self->answer();
                                });
    }

private:
    void answer() {
        shared_.unanswered.remove(this);
        const Request& request = parser_->get();
        head_ = request.method() == http::verb::head;
        keeps_ = !head_ && parser_->is_done() && parser_->keep_alive();
        const auto host = std::string_view(request[http::field::host].data(), request[http::field::host].size());
        // Of two, a proxy may have looked at the other.
        if (request.count(http::field::host) > 1 || request.count(http::field::origin) > 1)
            return refuse(http::status::bad_request, "one Host and one Origin");
        if (!shared_.access.knownHost(host)) return refuse(http::status::forbidden, "unknown host");
        const std::string_view target(request.target().data(), request.target().size());
        std::string_view rest;
        if (!shared_.access.below(target, rest))
            return refuse(http::status::forbidden, "This address needs the token that vdbview has printed.");
        if (request.method() == http::verb::put && rest.starts_with(kFiles) && shared_.limits.file_bytes > 0)
            return receive(host, rest.substr(kFiles.size()));
        if (!parser_->is_done()) return refuse(http::status::payload_too_large, "too large");
        if (rest == kSocket) return upgrade(host);
        if (request.method() != http::verb::get && request.method() != http::verb::head)
            return refuse(http::status::method_not_allowed, "only GET");
        const auto file = std::find_if(shared_.files.begin(), shared_.files.end(),
                                       [&](const PageFile& each) { return each.path == rest; });
        if (file == shared_.files.end()) return refuse(http::status::not_found, "no such page");
        send(http::status::ok, file->type, std::string(file->bytes));
    }

    bool isOfOwnPage(std::string_view host) {
        const auto origin = parser_->get()[http::field::origin];
        return shared_.access.ownOrigin({origin.data(), origin.size()}, host);
    }

    void upgrade(std::string_view host) {
        const Request& request = parser_->get();
        if (!beast::websocket::is_upgrade(request)) return refuse(http::status::upgrade_required, "a web socket");
        if (!isOfOwnPage(host)) return refuse(http::status::forbidden, kStranger);
        if (shared_.clients >= shared_.limits.clients)
            return refuse(http::status::service_unavailable, "too many pages are open");
        ++shared_.clients;
        upgraded_ = true;
        const auto gone = [&shared = shared_] {
            --shared.clients;
            --shared.connections;
            shared.freed();
        };
        std::make_shared<SocketClient>(std::move(stream_), shared_.handler, shared_.limits, gone)->start(request);
    }

    void receive(std::string_view host, std::string_view name) {
        if (!isOfOwnPage(host)) return refuse(http::status::forbidden, kStranger);
        if (shared_.receives) return refuse(http::status::service_unavailable, "another page sends a file; try again");
        try {
            incoming_ = shared_.handler.incoming(decoded(name));
        } catch (const std::exception& error) {
            return refuse(http::status::bad_request, error.what());
        }
        file_.emplace(std::move(*parser_));
        shared_.receives = true;
        beast::error_code error;
        file_->get().body().open(incoming_.c_str(), beast::file_mode::write_new, error);
        if (error) return refuse(http::status::insufficient_storage, incoming_.string() + ": can't be written");
        receiveSome();
    }

    // By pieces: who sends has his time for each, and not for all of them.
    void receiveSome() {
        stream_.expires_after(kPatience);
        http::async_read_some(stream_, buffer_, *file_,
                              [self = shared_from_this()](beast::error_code error, std::size_t) {
                                  if (error) return self->drop(error);
                                  if (!self->file_->is_done()) return self->receiveSome();
                                  self->file_->get().body().close();
                                  self->keeps_ = self->file_->keep_alive();
                                  std::string told;
                                  try {
                                      told = self->shared_.handler.arrived(self->incoming_);
                                  } catch (const std::exception& problem) {
                                      return self->refuse(http::status::bad_request, problem.what());
                                  }
                                  self->send(http::status::ok, kText, std::move(told));
                              });
    }

    // What has come of a file that will not be whole.
    void drop(beast::error_code error) {
        file_->get().body().close();
        std::error_code ignored;
        std::filesystem::remove(incoming_, ignored);
        const bool large = error == http::error::body_limit;
        refuse(large ? http::status::payload_too_large : http::status::insufficient_storage,
               large ? "too large" : error.message());
    }

    void refuse(http::status status, std::string_view why) {
        keeps_ = false;  // something of the request may still come
        send(status, kText, std::string(why) + "\n");
    }

    void send(http::status status, std::string_view type, std::string body) {
        response_.result(status);
        response_.version(11);
        response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
        response_.set(http::field::cache_control, "no-store");
        response_.set("Content-Security-Policy", kPolicy);
        response_.set("X-Content-Type-Options", "nosniff");
        response_.set("Referrer-Policy", "no-referrer");
        response_.set("Cross-Origin-Resource-Policy", "same-origin");
        response_.content_length(body.size());
        if (!head_) response_.body() = std::move(body);
        response_.keep_alive(keeps_);
        stream_.expires_after(kPatience);
        http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code error, std::size_t) {
            if (error) return;
            self->response_ = {};
            if (self->file_) self->shared_.receives = false;
            self->file_.reset();
            if (self->keeps_) return self->read();
            self->stream_.socket().shutdown(tcp::socket::shutdown_send, error);
        });
    }

    beast::tcp_stream stream_;
    Shared& shared_;
    beast::flat_buffer buffer_{kMostHeader};
    std::optional<http::request_parser<http::string_body>> parser_;
    std::optional<http::request_parser<http::file_body>> file_;  // of a file that the page sends
    std::filesystem::path incoming_;                             // its place
    bool head_ = false, keeps_ = false;                          // of the request: it is HEAD; another one may follow
    http::response<http::string_body> response_;
    bool upgraded_ = false;
};

std::string inUrl(const asio::ip::address& address) {
    return address.is_v6() ? fmt::format("[{}]", address.to_string()) : address.to_string();
}

}  // namespace

struct Server::Parts {
    std::optional<Shared> shared;  // before the context, whose end is that of the connections, which use it
    asio::io_context context{1};
    asio::steady_timer pause{context};
    tcp::acceptor acceptor{context};
    asio::signal_set signals{context, SIGINT, SIGTERM, SIGHUP};
    std::string url;
    bool accepting = false;
    std::vector<std::unique_ptr<asio::posix::stream_descriptor>> watched;

    void accept() {
        if (accepting) return;
        if (shared->connections >= shared->limits.connections) {
            // Who has sent no request goes before who comes now: nobody blocks the page by waiting.
            if (!shared->unanswered.empty()) shared->unanswered.front()->giveUp();
            return;
        }
        accepting = true;
        acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
            accepting = false;
            if (error == asio::error::operation_aborted) return;
            if (error) {
                // No descriptors are left, say: the next attempt would fail at once, too.
                pause.expires_after(kPause);
                pause.async_wait([this](beast::error_code stopped) {
                    if (!stopped) accept();
                });
                return;
            }
            socket.set_option(tcp::no_delay(true), error);
            std::make_shared<Connection>(std::move(socket), *shared)->read();
            accept();
        });
    }

    void wait(asio::posix::stream_descriptor& descriptor, const std::function<void()>& ready) {
        descriptor.async_wait(asio::posix::stream_descriptor::wait_read,
                              [this, &descriptor, ready](beast::error_code error) {
                                  if (error) return;
                                  ready();
                                  wait(descriptor, ready);
                              });
    }
};

std::filesystem::path Handler::incoming(std::string_view) { throw InputError("no files are taken here"); }
std::string Handler::arrived(const std::filesystem::path&) { return {}; }

bool isLoopback(const std::string& address) {
    beast::error_code error;
    return asio::ip::make_address(address, error).is_loopback() && !error;
}

Server::Server(const ServerOptions& options, std::vector<PageFile> files, Handler& handler)
    : parts_(std::make_unique<Parts>()) {
    beast::error_code error;
    const auto address = asio::ip::make_address(options.address, error);
    if (error)
        throw UsageError(
            fmt::format("{}: is no address to listen on; give one of this machine's, e.g. 127.0.0.1 or "
                        "0.0.0.0",
                        options.address));
    const tcp::endpoint place(address, options.port);
    tcp::acceptor& acceptor = parts_->acceptor;
    const auto attempt = [&](const auto& step) {
        if (!error) step();
    };
    attempt([&] { acceptor.open(place.protocol(), error); });
    attempt([&] { acceptor.set_option(asio::socket_base::reuse_address(true), error); });
    attempt([&] { acceptor.bind(place, error); });
    attempt([&] { acceptor.listen(asio::socket_base::max_listen_connections, error); });
    if (error)
        throw UsageError(
            fmt::format("{}, port {}: can't listen there ({})", options.address, options.port, error.message()));
    const std::uint16_t port = acceptor.local_endpoint().port();
    const std::vector<std::string> hosts{"127.0.0.1", "localhost", "[::1]", inUrl(address)};
    const std::string token = options.token.empty() ? randomToken() : options.token;
    const bool any = address.is_unspecified();
    parts_->url = fmt::format("http://{}:{}/{}/", any ? std::string("127.0.0.1") : inUrl(address), port, token);
    parts_->shared.emplace(handler, options.limits, std::move(files), Access(token, hosts, port, options.hosts));
    // Not at once: the connection that is over is still being destroyed.
    parts_->shared->freed = [parts = parts_.get()] { asio::post(parts->context, [parts] { parts->accept(); }); };
}

Server::~Server() {
    parts_->context.stop();
    parts_->shared->freed = [] {};
}

std::string Server::url() const { return parts_->url; }

void Server::run() {
    parts_->signals.async_wait([this](beast::error_code error, int) {
        if (!error) parts_->context.stop();
    });
    parts_->accept();
    parts_->context.run();
}

void Server::stop() { parts_->context.stop(); }

void Server::watch(int descriptor, const std::function<void()>& ready) {
    parts_->watched.push_back(std::make_unique<asio::posix::stream_descriptor>(parts_->context, descriptor));
    parts_->wait(*parts_->watched.back(), ready);
}

}  // namespace stratum::serve
