#include "view/loading_events.h"

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace stratum::view {

assemble::ReadEvents loadingEvents(std::function<void(const nlohmann::json& message)> tell) {
    using Clock = std::chrono::steady_clock;
    struct State {
        std::function<void(const nlohmann::json& message)> tell;
        std::string step;
        Clock::time_point told;
    };
    const auto state = std::make_shared<State>(State{std::move(tell), {}, {}});
    assemble::ReadEvents events;
    events.begin = [state](std::string_view step, bool) {
        state->step = step;
        state->tell({{"type", "loading"}, {"step", step}});
    };
    events.fraction = [state](double done) {
        if (Clock::now() - state->told < std::chrono::milliseconds(100)) return;
        state->told = Clock::now();
        state->tell({{"type", "loading"}, {"step", state->step}, {"done", done}});
    };
    return events;
}

}  // namespace stratum::view
