#include "view/viewport.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "shade/film/lossy_writers.h"
#include "shade/film/tonemap.h"
#include "shade/integrator/deep_light.h"
#include "shade/post/denoise.h"
#include "view/beads/bead_look.h"
#include "view/inspect.h"
#include "view/loading_events.h"
#include "view/picture/quick_picture.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <new>
#include <type_traits>
#include <utility>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

constexpr double kFrameSeconds = 0.050;
constexpr int kMostOnTheWay = 2;  // pictures that are sent before the first of them is shown
constexpr std::size_t kMostQueued = 16;
constexpr auto kRest = std::chrono::milliseconds(350);  // after the last movement, if nobody says that it is over
constexpr double kQuickBuild = 0.1;                     // seconds; no need for anything to stand in
constexpr int kMovingQuality = 80, kRoughQuality = 92;

std::vector<std::uint8_t> movingPicture(const ViewedPicture& picture, shade::RenderOptions options) {
    if (shade::needsLight(options.integrator)) return quickPicture(picture, *picture.bare_light);
    options.width = picture.scene.camera.width();
    options.height = picture.scene.camera.height();
    options.spp = 1;
    options.aovs.clear();
    options.noise = 0.0;
    return shade::toDisplay(shade::render(*picture.print, picture.scene, options).film, picture.tone);
}

std::string fileNameOf(const std::string& path) { return std::filesystem::path(path).filename().string(); }

}  // namespace

Viewport::Viewport(Document& document, Output output)
    : document_(document),
      output_(std::move(output)),
      frame_scale_(kFrameSeconds),
      beads_(document, output_),
      moves_(document, output_) {}

void Viewport::startWith(const ViewScene& scene) {
    scene_.emplace(scene);
    const std::lock_guard lock(mutex_);
    started_ = true;
}

void Viewport::ask(Message message) {
    const std::lock_guard lock(mutex_);
    std::visit(
        [this](auto& it) {
            using Kind = std::decay_t<decltype(it)>;
            if constexpr (std::is_same_v<Kind, ShowMessage>) asked_ = std::move(it);
            if constexpr (std::is_same_v<Kind, InspectMessage>)
                if (inspects_.size() < kMostQueued) inspects_.push_back(it);
            if constexpr (std::is_same_v<Kind, SaveMessage>)
                if (saves_.size() < kMostQueued) saves_.push_back(std::move(it));
            if constexpr (std::is_same_v<Kind, CancelMessage>) saves_.clear();
            if constexpr (std::is_same_v<Kind, BeadsMessage>) beads_asked_ = true;
            if constexpr (std::is_same_v<Kind, MovesMessage>) moves_asked_ = true;
            if constexpr (std::is_same_v<Kind, LayersMessage>) layers_asked_ = true;
            if constexpr (std::is_same_v<Kind, ProgramMessage>) program_ = it;
            if constexpr (std::is_same_v<Kind, FindMessage>) find_ = std::move(it);
            if constexpr (std::is_same_v<Kind, ShownMessage>) on_the_way_ = std::max(0, on_the_way_ - 1);
        },
        message);
}

void Viewport::restart() {
    const std::lock_guard lock(mutex_);
    if (!asked_ && plan_) asked_ = current_;
    if (asked_) asked_->moving = false;
}

bool Viewport::hasWork(bool urgent) const {
    const std::lock_guard lock(mutex_);
    if (!started_) return false;
    const bool may_send = on_the_way_ < kMostOnTheWay;
    if ((asked_ && may_send) || !inspects_.empty() || program_ || find_ || (stage_ == Stage::moving && may_send))
        return true;
    // What else there is to do waits until the page has taken what is on its way.
    if (urgent || asked_ || stage_ == Stage::moving) return false;
    if (((beads_asked_ || moves_asked_) && may_send) || layers_asked_) return true;
    if (stage_ == Stage::waiting) return Clock::now() >= rest_at_;
    return stage_ == Stage::exact || stage_ == Stage::rough || stage_ == Stage::final || !saves_.empty() || saving_;
}

std::optional<Viewport::Clock::time_point> Viewport::worksAt() const {
    const std::lock_guard lock(mutex_);
    if (stage_ != Stage::waiting) return std::nullopt;
    return rest_at_;
}

bool Viewport::overtaken() const {
    const std::lock_guard lock(mutex_);
    return (asked_ && on_the_way_ < kMostOnTheWay) || !inspects_.empty() || program_ || find_;
}

void Viewport::set(Stage stage) {
    const std::lock_guard lock(mutex_);
    stage_ = stage;
}

void Viewport::take() {
    std::optional<ShowMessage> asked;
    {
        const std::lock_guard lock(mutex_);
        if (!asked_ || on_the_way_ >= kMostOnTheWay) return;
        asked = std::exchange(asked_, std::nullopt);
        stage_ = Stage::idle;
    }
    current_ = std::move(*asked);
    still_.reset();
    rough_cache_.reset();
    full_.reset();
    document_.update();
    plan_ = planPicture(document_.given(), current_.state);
    // A page that draws what moves wants nothing meanwhile, also not the processor's time.
    if (current_.own) return set(current_.moving ? Stage::idle : Stage::exact);
    set(Stage::moving);
}

void Viewport::step(const std::function<void()>& check) {
    try {
        take();
        work(check);
    } catch (const std::bad_alloc&) {
        fail("there is not enough memory for this view; show fewer layers, or start the viewer with larger voxels");
    } catch (const std::exception& error) {
        fail(error.what());
    }
}

void Viewport::stop() {
    still_.reset();
    rough_cache_.reset();
    saving_.reset();
    full_.reset();
    const std::lock_guard lock(mutex_);
    stage_ = Stage::idle;
    saves_.clear();
}

void Viewport::fail(const std::string& text) {
    stop();
    output_.text({{"type", "failed"}, {"number", current_.number}, {"text", text}});
}

void Viewport::work(const std::function<void()>& check) {
    std::optional<InspectMessage> inspect;
    std::optional<ProgramMessage> program;
    std::optional<FindMessage> find;
    Stage stage = Stage::idle;
    bool beads = false;
    bool moves = false;
    bool layers = false;
    bool saves = false;
    {
        const std::lock_guard lock(mutex_);
        if (!inspects_.empty()) {
            inspect = inspects_.front();
            inspects_.pop_front();
        }
        if (stage_ == Stage::waiting && Clock::now() >= rest_at_) stage_ = Stage::exact;
        stage = stage_;
        saves = !saves_.empty() || saving_;
        program = std::exchange(program_, std::nullopt);
        find = std::exchange(find_, std::nullopt);
        const bool answers = inspect || program || find;
        const bool may_send = on_the_way_ < kMostOnTheWay && stage != Stage::moving;
        beads = beads_asked_ && may_send;
        moves = moves_asked_ && may_send && !beads;
        layers = !answers && !beads && !moves && stage != Stage::moving && std::exchange(layers_asked_, false);
        on_the_way_ += !answers && (beads || moves) ? 1 : 0;
        if (stage == Stage::moving && on_the_way_ >= kMostOnTheWay) stage = Stage::waiting;
    }
    if (program) answer("program", [&] { return document_.programAt(program->bead); });
    if (find) answer("found", [&] { return document_.find(*find); });
    if (inspect) return answer(*inspect);
    if (program || find) return;
    if (layers) return answer("layers", [&] { return document_.layers(); });
    if (beads || moves) {
        const bool more = beads ? beads_.sendPart() : moves_.sendPart();
        const std::lock_guard lock(mutex_);
        bool& asked = beads ? beads_asked_ : moves_asked_;
        asked = asked && more;
        return;
    }
    switch (stage) {
        case Stage::moving:
            return showMoving();
        case Stage::exact:
            return makeExact();
        case Stage::rough:
            return showRough(check);
        case Stage::final:
            // Who saves has seen enough of the view, and waits.
            return saves ? save(check) : workOnFinal(check);
        case Stage::idle:
            return save(check);
        case Stage::waiting:
            return;
    }
}

void Viewport::makeExact() {
    if (!scene_->has(*plan_)) {
        scene_->makeObjects(*plan_, loadingEvents(output_.text));
        output_.text({{"type", "facts"}, {"facts", document_.facts()}});
    }
    Json described = scene_->describe();
    described["type"] = "scene";
    output_.text(described);
    if (current_.own) return showOwn();
    set(Stage::rough);
}

// The page draws what moves: it needs no rough picture either.
void Viewport::showOwn() {
    const shade::RenderOptions& options = plan_->options.render;
    full_ = scene_->picture(*plan_, options.width, options.height);
    beads_.sendLook(*full_, *plan_, *scene_, current_.number);
    set(Stage::final);
}

// Of the exact objects if they are there or soon made, else of what can stand in for them.
ViewedPicture Viewport::small(const PicturePlan& plan, int width, int height, bool* exact) {
    *exact = scene_->has(plan);
    if (!*exact && scene_->canStandIn(plan) && scene_->buildSeconds() > kQuickBuild)
        return scene_->standIn(plan, current_.state, width, height);
    if (!*exact) makeExact();
    *exact = true;
    return scene_->picture(plan, width, height, ViewScene::Light::near);
}

void Viewport::showMoving() {
    PicturePlan plan = *plan_;
    const ViewState& state = current_.state;
    const double scale = frame_scale_.scale(state.width, state.height);
    const int width = std::max(16, static_cast<int>(std::lround(scale * state.width)));
    const int height = std::max(16, static_cast<int>(std::lround(scale * state.height)));
    bool exact = false;
    const ViewedPicture picture = small(plan, width, height, &exact);
    Stopwatch watch;
    const std::vector<std::uint8_t> rgb = movingPicture(picture, plan.options.render);
    frame_scale_.took(static_cast<double>(width) * height, watch.lap());
    send("moving", "image/jpeg", width, height, picture, plan, current_.number,
         shade::encodeJpeg(width, height, rgb, kMovingQuality));
    const std::lock_guard lock(mutex_);
    rest_at_ = Clock::now() + kRest;
    stage_ = current_.moving ? Stage::waiting : Stage::exact;
}

void Viewport::showRough(const std::function<void()>& check) {
    PicturePlan plan = *plan_;
    shade::RenderOptions options = plan.options.render;
    // A picture whose light needs no denoising is soon finished anyway.
    if (!plan.denoise) return set(Stage::final);
    options.width = std::max(16, options.width / 2);
    options.height = std::max(16, options.height / 2);
    options.spp = 4;
    options.noise = 0.0;
    if (!rough_cache_) rough_cache_ = std::make_shared<shade::RadianceCacheWork>();
    options.integrator.cache_work = rough_cache_;
    const ViewedPicture picture = scene_->picture(plan, options.width, options.height);
    const auto checked = [&check](std::uint64_t, std::uint64_t) { check(); };
    shade::RenderResult result = shade::render(*picture.print, picture.scene, options, checked);
    shade::denoise(result.film, checked);
    send("rough", "image/jpeg", options.width, options.height, picture, plan, current_.number,
         shade::encodeJpeg(options.width, options.height, shade::toDisplay(result.film, picture.tone), kRoughQuality));
    set(Stage::final);
}

void Viewport::workOnFinal(const std::function<void()>& check) {
    const shade::RenderOptions& options = plan_->options.render;
    if (!still_) {
        // A picture that was saved meanwhile may have had other objects.
        if (!scene_->has(*plan_)) scene_->makeObjects(*plan_, loadingEvents(output_.text));
        if (!full_) full_ = scene_->picture(*plan_, options.width, options.height);
        still_ = std::make_unique<StillPicture>(*full_, *plan_, fileNameOf(document_.given().source),
                                                scene_->sharedObjects());
    }
    if (!still_->done()) {
        still_->traceBand(check);
        output_.text({{"type", "progress"}, {"number", current_.number}, {"done", still_->progress()}});
        return;
    }
    still_->finish(check);
    send("final", "image/png", options.width, options.height, *full_, *plan_, current_.number, still_->png());
    still_.reset();
    rough_cache_.reset();
    set(Stage::idle);
}

// What can't be saved spoils no picture of the view.
void Viewport::save(const std::function<void()>& check) {
    const auto refuse = [this](const char* why) {
        saving_.reset();
        {
            const std::lock_guard lock(mutex_);
            if (!saves_.empty()) saves_.pop_front();
        }
        output_.text({{"type", "not-saved"}, {"text", why}});
    };
    try {
        workOnSave(check);
    } catch (const std::bad_alloc&) {
        refuse("there is not enough memory for this picture; save a smaller one");
    } catch (const std::exception& error) {
        refuse(error.what());
    }
}

void Viewport::workOnSave(const std::function<void()>& check) {
    SaveMessage save;
    {
        const std::lock_guard lock(mutex_);
        if (saves_.empty()) return saving_.reset();  // it was given up
        save = saves_.front();
    }
    if (saving_number_ != save.number) saving_.reset();  // it was given up, and another one asked for since
    if (!saving_) {
        const PicturePlan plan = planPicture(document_.given(), save.state);
        const shade::RenderOptions& options = plan.options.render;
        scene_->makeObjects(plan, loadingEvents(output_.text));
        saving_ = std::make_unique<StillPicture>(scene_->picture(plan, options.width, options.height), plan,
                                                 fileNameOf(document_.given().source), scene_->sharedObjects());
        saving_number_ = save.number;
    }
    const shade::RenderOptions& options = saving_->plan().options.render;
    if (!saving_->done()) {
        saving_->traceBand(check);
        output_.text({{"type", "saving"}, {"number", save.number}, {"done", saving_->progress()}});
        return;
    }
    saving_->finish(check);
    send("saved", "image/png", options.width, options.height, saving_->picture(), saving_->plan(), save.number,
         saving_->png());
    saving_.reset();
    const std::lock_guard lock(mutex_);
    if (!saves_.empty() && saves_.front().number == save.number) saves_.pop_front();
}

// What can't be told spoils no picture.
void Viewport::answer(const char* type, const std::function<Json()>& of_document) {
    try {
        Json answer = of_document();
        answer["type"] = type;
        output_.text(answer);
    } catch (const InputError& error) {
        output_.text({{"type", "refused"}, {"text", error.what()}});
    }
}

void Viewport::answer(const InspectMessage& inspect) {
    if (!plan_) return;
    if (!scene_->has(*plan_)) scene_->makeObjects(*plan_, loadingEvents(output_.text));
    const shade::RenderOptions& options = plan_->options.render;
    if (!full_) full_ = scene_->picture(*plan_, options.width, options.height);
    Json answer = view::inspect(document_, *scene_, *full_, {inspect.x * options.width, inspect.y * options.height});
    answer["type"] = "inspected";
    answer["number"] = inspect.number;
    output_.text(answer);
}

void Viewport::send(const char* kind, const char* type, int width, int height, const ViewedPicture& picture,
                    const PicturePlan& plan, std::uint64_t number, const std::vector<std::uint8_t>& file) {
    Json head{{"type", "picture"},
              {"kind", kind},
              {"number", number},
              {"media", type},
              {"width", width},
              {"height", height},
              {"camera", cameraJson(picture.scene.camera)},
              {"exposure", picture.tone.exposure},
              {"command", shellLine(plan.words)}};
    {
        const std::lock_guard lock(mutex_);
        ++on_the_way_;
    }
    output_.picture(head, file);
}

}  // namespace stratum::view
