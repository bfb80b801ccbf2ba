// A server on a thread of its own, and what it heard.
#pragma once

#include "raw_client.h"
#include "serve/server.h"

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace stratum::test {

/// Answers every message by what `answer` does with it.
class Recorder final : public serve::Handler {
public:
    using Clients = std::shared_ptr<serve::Client>;
    std::function<void(const Clients&, std::string_view)> answer = [](const Clients& client, std::string_view text) {
        client->sendText("heard " + std::string(text));
    };

    void opened(const Clients& client) override { note("opened", client); }
    void received(const Clients& client, std::string_view text) override {
        note(std::string(text), client);
        answer(client, text);
    }
    void closed(const Clients& client) override { note("closed", client); }
    /// Files that are sent get places here; empty: they are refused.
    std::filesystem::path folder;
    std::filesystem::path incoming(std::string_view name) override {
        if (folder.empty()) return Handler::incoming(name);
        note("incoming " + std::string(name), {});
        return folder / "sent";
    }
    std::string arrived(const std::filesystem::path& path) override { return path.filename().string() + " is there"; }

    /// Whether it happens within 20 s.
    bool waitFor(const std::string& event) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(20),
                                 [&] { return std::find(events_.begin(), events_.end(), event) != events_.end(); });
    }
    Clients last() {
        const std::lock_guard lock(mutex_);
        return last_;
    }
    /// Before the server ends: clients live no longer.
    void forget() {
        const std::lock_guard lock(mutex_);
        last_.reset();
    }

private:
    void note(std::string event, const Clients& client) {
        const std::lock_guard lock(mutex_);
        events_.push_back(std::move(event));
        last_ = client;
        changed_.notify_all();
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::string> events_;
    Clients last_;
};

class RunningServer {
public:
    explicit RunningServer(const serve::Limits& limits = {}) : RunningServer(optionsOf(limits)) {}
    explicit RunningServer(const serve::ServerOptions& options)
        : server_(options, {{"", "text/html", "<!doctype html>page"}, {"main.js", "text/javascript", "script"}},
                  recorder),
          page(server_.url()),
          thread_([this] { server_.run(); }) {}
    ~RunningServer() {
        server_.stop();
        thread_.join();
        recorder.forget();
    }
    RunningServer(const RunningServer&) = delete;
    RunningServer& operator=(const RunningServer&) = delete;

    RawClient client() const { return RawClient(page.port); }

    Recorder recorder;

private:
    static serve::ServerOptions optionsOf(const serve::Limits& limits) {
        serve::ServerOptions options;
        options.limits = limits;
        return options;
    }
    serve::Server server_;

public:
    const PageAddress page;

private:
    std::thread thread_;  // the last one: it uses the others
};

}  // namespace stratum::test
