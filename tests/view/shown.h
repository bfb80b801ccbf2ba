// What a page would be sent.
#pragma once

#include "view/asked/message.h"
#include "view/input/output.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace stratum::test {

/// Collects it, from any thread; the file of a picture as "bytes".
class Shown {
public:
    view::Output output() {
        return {[this](const nlohmann::json& message) { note(message); },
                [this](nlohmann::json head, const std::vector<std::uint8_t>& file) {
                    head["bytes"] = file;
                    note(head);
                }};
    }
    void note(const nlohmann::json& message) {
        const std::lock_guard lock(mutex_);
        messages_.push_back(message);
        changed_.notify_all();
    }

    /// The first message of this type, and of this number or kind if they are given, within 60 s; null: none came.
    nlohmann::json waitFor(const std::string& type, std::uint64_t number = 0, const std::string& kind = "") {
        std::unique_lock lock(mutex_);
        nlohmann::json found;
        (void)changed_.wait_for(lock, std::chrono::seconds(60), [&] {
            for (const nlohmann::json& message : messages_)
                if (message.value("type", "") == type && (number == 0 || message.value("number", 0U) == number) &&
                    (kind.empty() || message.value("kind", "") == kind)) {
                    found = message;
                    return true;
                }
            return false;
        });
        return found;
    }
    /// Kinds of pictures, in order.
    std::vector<std::string> kinds() {
        const std::lock_guard lock(mutex_);
        std::vector<std::string> kinds;
        for (const nlohmann::json& message : messages_)
            if (message.value("type", "") == "picture") kinds.push_back(message["kind"]);
        return kinds;
    }
    void clear() {
        const std::lock_guard lock(mutex_);
        messages_.clear();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<nlohmann::json> messages_;
};

/// A view that is soon made.
inline view::ViewState smallState(int width = 64) {
    view::ViewState state;
    state.width = width;
    state.height = 48;
    state.named = shade::View::iso;
    state.spp = 2;
    return state;
}

inline view::ShowMessage show(std::uint64_t number, const view::ViewState& state) {
    view::ShowMessage message;
    message.number = number;
    message.state = state;
    return message;
}

}  // namespace stratum::test
