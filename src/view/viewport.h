// One page's picture: from a quick one while it moves to the finished one at rest.
#pragma once

#include "view/asked/message.h"
#include "view/beads/bead_stream.h"
#include "view/beads/move_stream.h"
#include "view/input/document.h"
#include "view/input/output.h"
#include "view/input/view_scene.h"
#include "view/picture/frame_scale.h"
#include "view/picture/still_picture.h"

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace stratum::view {

/// Asked from any thread, worked on one thread. Pictures, from the first:
/// A page that draws beads itself gets what it needs for that (bead_stream.h), and the final one alone. Others:
///   moving  in a size that keeps the frame rate, with ambient occlusion (quick_picture.h), as JPEG
///   rough   at rest: half of the size, few samples of the full light, denoised, as JPEG
///   final   the PNG of vdbtrace
class Viewport {
public:
    using Clock = std::chrono::steady_clock;
    Viewport(Document& document, Output output);

    /// Takes over what is read of the document's input. On the thread of step().
    void startWith(const ViewScene& scene);

    // From any thread.
    void ask(Message message);
    /// The file has changed: all pictures are made again.
    void restart();
    /// Whether step() has work; `urgent`: for a view that moves.
    bool hasWork(bool urgent) const;
    /// When it will have some; nothing if not before it is asked.
    std::optional<Clock::time_point> worksAt() const;
    /// Whether something newer was asked for than what is being worked on.
    bool overtaken() const;

    /// Does one piece of work. `check` is called between tiles of what may be put off; what it throws ends the piece,
    /// which is done again later, and is passed on.
    void step(const std::function<void()>& check);
    /// There is no picture of what was asked for: gives up what is at work, and says so. On the thread of step().
    void fail(const std::string& text);
    Document& document() { return document_; }
    const Output& output() const { return output_; }

private:
    enum class Stage { idle, moving, waiting, exact, rough, final };

    void take();
    void work(const std::function<void()>& check);
    void showMoving();
    void showOwn();
    void showRough(const std::function<void()>& check);
    void makeExact();
    void workOnFinal(const std::function<void()>& check);
    void save(const std::function<void()>& check);
    void workOnSave(const std::function<void()>& check);
    void answer(const InspectMessage& inspect);
    void answer(const char* type, const std::function<nlohmann::json()>& of_document);
    void stop();
    void send(const char* kind, const char* type, int width, int height, const ViewedPicture& picture,
              const PicturePlan& plan, std::uint64_t number, const std::vector<std::uint8_t>& file);
    ViewedPicture small(const PicturePlan& plan, int width, int height, bool* exact);
    void set(Stage stage);

    Document& document_;
    std::optional<ViewScene> scene_;
    const Output output_;

    mutable std::mutex mutex_;  // of the next ones
    std::optional<ShowMessage> asked_;
    std::deque<InspectMessage> inspects_;
    std::deque<SaveMessage> saves_;
    std::optional<ProgramMessage> program_;
    std::optional<FindMessage> find_;
    bool beads_asked_ = false, moves_asked_ = false, layers_asked_ = false;
    int on_the_way_ = 0;  // pictures and parts of tables that the page has not taken yet
    bool started_ = false;
    Stage stage_ = Stage::idle;
    Clock::time_point rest_at_;

    // Of the working thread.
    ShowMessage current_;
    std::optional<PicturePlan> plan_;
    std::unique_ptr<StillPicture> still_, saving_;
    std::shared_ptr<shade::RadianceCacheWork> rough_cache_;  // of the rough picture, if its light needs one
    std::uint64_t saving_number_ = 0;                        // of the message that saving_ answers
    std::optional<ViewedPicture>
        full_;  // of the exact objects in the full size, for the finished picture and inspect()
    FrameScale frame_scale_;
    BeadStream beads_;
    MoveStream moves_;
};

}  // namespace stratum::view
