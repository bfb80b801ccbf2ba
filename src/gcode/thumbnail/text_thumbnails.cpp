#include "gcode/thumbnail/text_thumbnails.h"

#include "base/base64.h"
#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr std::string_view kWhite = " \t\r";
constexpr std::string_view kWord = "thumbnail";
constexpr std::string_view kOrcaStart = "THUMBNAIL_BLOCK_START";
constexpr std::size_t kHead = std::size_t{1} << 16;  // where slicers say who they are
constexpr std::size_t kRow = 78;                     // characters of base64

// Begin and end of a line, its line end excluded and included.
struct Line {
    std::size_t begin = 0, end = 0, next = 0;
    std::string_view in(std::string_view text) const { return text.substr(begin, end - begin); }
};

Line lineAt(std::string_view text, std::size_t at) {
    const std::size_t before = at == 0 ? std::string_view::npos : text.rfind('\n', at - 1);
    const std::size_t end = std::min(text.find('\n', at), text.size());
    return {before == std::string_view::npos ? 0 : before + 1, end, std::min(end + 1, text.size())};
}

// What a comment says; empty if the line is none.
std::string_view commentOf(std::string_view line) {
    line = trim(line, kWhite);
    return line.starts_with(';') ? trim(line.substr(1), kWhite) : std::string_view();
}

bool isLoneSemicolon(std::string_view line) { return trim(line, kWhite) == ";"; }
bool isBlankLine(std::string_view line) { return trim(line, kWhite).empty(); }

// "thumbnail_QOI" of "thumbnail_QOI begin 16x16 600"; empty if the comment begins no block.
std::string_view tagOf(std::string_view comment, std::string_view what) {
    const std::string_view tag = comment.substr(0, comment.find(' '));
    const std::string_view rest = trim(comment.substr(tag.size()), kWhite);
    const bool known = tag == kWord || (tag.starts_with("thumbnail_") && tag.size() <= 16);
    const bool says = rest.starts_with(what) && (rest.size() == what.size() || rest[what.size()] == ' ');
    return known && says ? tag : std::string_view();
}

struct TextBlock {
    std::size_t begin = 0, end = 0;
    bool spaced = false;  // "begin 300 300", as Cura has it, not "begin 300x300"
    bool png = false;
};

class BlockFinder {
public:
    BlockFinder(std::string_view text, std::string_view name) : text_(text), name_(name) {}

    std::vector<TextBlock> all() const {
        std::vector<TextBlock> blocks;
        for (std::size_t at = 0; (at = text_.find(kWord, at)) != std::string_view::npos;) {
            const Line line = lineAt(text_, at);
            const std::string_view tag = tagOf(commentOf(line.in(text_)), "begin");
            if (tag.empty()) {
                at = line.next;
                continue;
            }
            const std::size_t least = blocks.empty() ? 0 : blocks.back().end;
            blocks.push_back(withFrame(line, endOf(line, tag), least));
            at = blocks.back().end;
        }
        return blocks;
    }

private:
    // The last line of a block.
    Line endOf(const Line& begin, std::string_view tag) const {
        for (std::size_t at = begin.next; at < text_.size();) {
            const Line line = lineAt(text_, at);
            const std::string_view said = line.in(text_);
            if (tagOf(commentOf(said), "end") == tag) return line;
            // Only comments are removed, whatever is damaged.
            if (!trim(said, kWhite).starts_with(';')) break;
            at = line.next;
        }
        throw InputError(fmt::format(
            "{}: line {}: a thumbnail begins here and has no end, '; {} end'; delete its lines, or export "
            "the file again",
            name_, 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(begin.begin), '\n'), tag));
    }

    // The lines around a block that slicers write with it.
    TextBlock withFrame(const Line& first, const Line& last, std::size_t least) const {
        const std::string_view said = first.in(text_);
        const std::string_view size = trim(said.substr(said.find("begin") + 5), kWhite);
        TextBlock block{first.begin, last.next, size.substr(0, size.find(' ')).find('x') == std::string_view::npos,
                        !tagOf(commentOf(said), "begin").starts_with("thumbnail_")};
        const auto take = [&](auto&& fits) {
            if (block.begin <= least) return;
            const Line before = lineAt(text_, block.begin - 1);
            if (before.begin >= least && fits(before.in(text_))) block.begin = before.begin;
        };
        take(isLoneSemicolon);
        if (!block.spaced) take(isBlankLine);
        if (block.end < text_.size()) {
            const Line after = lineAt(text_, block.end);
            if (isLoneSemicolon(after.in(text_))) block.end = after.next;
        }
        return block;
    }

    std::string_view text_, name_;
};

// The line of a comment that begins so.
std::optional<Line> findComment(std::string_view text, std::string_view begin) {
    for (std::size_t at = 0; (at = text.find(begin, at)) != std::string_view::npos;) {
        const Line line = lineAt(text, at);
        if (commentOf(line.in(text)).starts_with(begin)) return line;
        at = line.next;
    }
    return std::nullopt;
}

// Where new thumbnails go, and what stands around them.
struct Place {
    std::size_t at = 0;
    bool spaced = false, orca = false;
};

Place placeIn(std::string_view text) {
    const std::string_view head = text.substr(0, kHead);
    if (const auto line = findComment(text, kOrcaStart)) return {line->next, false, false};
    if (const auto line = findComment(head, "HEADER_BLOCK_END")) return {line->next, false, true};
    if (const auto line = findComment(head, "Generated with Cura")) return {line->next, true, false};
    if (const auto line = findComment(head, "generated by ")) return {line->next, false, false};
    const Line first = lineAt(text, 0);
    const bool marked = text.starts_with("\xef\xbb\xbf");  // as UTF-8: stays in front
    return {marked || !commentOf(first.in(text)).empty() ? first.next : 0, false, false};
}

// Where those are that there are, in their form. The others than PNG don't say which form is Cura's.
Place placeOf(std::string_view text, const std::vector<TextBlock>& old) {
    if (old.empty()) return placeIn(text);
    const auto png = std::find_if(old.begin(), old.end(), [](const TextBlock& block) { return block.png; });
    const bool cura = findComment(text.substr(0, kHead), "Generated with Cura").has_value();
    return {old.front().begin, png != old.end() ? png->spaced : cura, false};
}

std::string blockOf(const Thumbnail& thumbnail, bool spaced, std::string_view eol) {
    const ThumbnailSize& size = thumbnail.size;
    std::string tag(kWord);
    if (size.coding != ThumbnailCoding::png) tag += fmt::format("_{}", codingName(size.coding));
    const std::string base64 = base64Of(thumbnail.bytes);
    // Cura knows no others than PNG; readers of those take PrusaSlicer's form.
    spaced = spaced && size.coding == ThumbnailCoding::png;
    std::string text = fmt::format("{};{}", spaced ? "" : eol, eol);
    text += fmt::format("; {} begin {}{}{} {}{}", tag, size.width, spaced ? ' ' : 'x', size.height, base64.size(), eol);
    for (std::size_t at = 0; at < base64.size(); at += kRow)
        text += fmt::format("; {}{}", std::string_view(base64).substr(at, kRow), eol);
    text += fmt::format("; {} end{};{}", tag, eol, eol);
    return text;
}

std::string_view lineEndOf(std::string_view text) {
    const std::size_t end = text.find('\n');
    return end != std::string_view::npos && end > 0 && text[end - 1] == '\r' ? "\r\n" : "\n";
}

}  // namespace

bool hasThumbnailPlace(std::string_view text, std::string_view name) {
    return findComment(text, kOrcaStart).has_value() || !BlockFinder(text, name).all().empty();
}

PatchedBytes withTextThumbnails(std::string_view text, std::span<const Thumbnail> thumbnails, std::string_view name) {
    const std::vector<TextBlock> old = BlockFinder(text, name).all();
    const Place place = placeOf(text, old);
    const std::string_view eol = lineEndOf(text);
    std::string blocks;
    for (const Thumbnail& thumbnail : thumbnails) blocks += blockOf(thumbnail, place.spaced, eol);
    if (place.orca) blocks = fmt::format("{}; {}{}{}; THUMBNAIL_BLOCK_END{}", eol, kOrcaStart, eol, blocks, eol);
    // A file of one line without an end.
    if (place.at > 0 && text[place.at - 1] != '\n') blocks.insert(0, eol);
    PatchedBytes result;
    result.keep(text.substr(0, place.at));
    result.add(std::move(blocks));
    std::size_t at = place.at;
    for (const TextBlock& block : old) {
        result.keep(text.substr(at, block.begin - at));
        at = block.end;
    }
    result.keep(text.substr(at));
    return result;
}

}  // namespace stratum::gcode
