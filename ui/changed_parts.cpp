#include "changed_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relamp::ui {
namespace {

bool sameVertex(const ImDrawVert& a, const ImDrawVert& b) {
    return a.pos.x == b.pos.x && a.pos.y == b.pos.y && a.uv.x == b.uv.x && a.uv.y == b.uv.y && a.col == b.col;
}

struct Box {
    ImVec2 low{1e9f, 1e9f}, high{-1e9f, -1e9f};
    void add(const ImVec2& p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    bool empty() const { return low.x > high.x; }
};

void addAll(Box& box, const ImDrawVert* vertices, size_t from, size_t to) {
    for (size_t i = from; i < to; ++i) box.add(vertices[i].pos);
}

bool overlap(const ChangedPart& a, const ChangedPart& b) {
    return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

ChangedPart joined(const ChangedPart& a, const ChangedPart& b) {
    return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y)},
            {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y)}};
}

/// Parts that do not overlap; more than a few become one.
std::vector<ChangedPart> apart(std::vector<ChangedPart> parts) {
    constexpr size_t most = 6;
    for (size_t i = 0; i < parts.size(); ++i)
        for (size_t j = i + 1; j < parts.size(); ++j)
            if (parts.size() > most || overlap(parts[i], parts[j])) {
                parts[i] = joined(parts[i], parts[j]);
                parts.erase(parts.begin() + long(j));
                i = size_t(-1);  // the larger one may touch those before
                break;
            }
    return parts;
}

}  // namespace

std::vector<ChangedPart> ChangedParts::next(const ImDrawData& data, ImTextureID changing) {
    std::vector<ChangedPart> parts;
    const auto take = [&](const Box& box) {
        if (box.empty()) return;
        const ImVec2 low{std::max(0.0f, std::floor(box.low.x) - 1), std::max(0.0f, std::floor(box.low.y) - 1)},
            high{std::min(data.DisplaySize.x, std::ceil(box.high.x) + 1),
                 std::min(data.DisplaySize.y, std::ceil(box.high.y) + 1)};
        if (low.x < high.x && low.y < high.y) parts.push_back({low, high});
    };
    bool same =
        lists_.size() == size_t(data.CmdListsCount) && size_.x == data.DisplaySize.x && size_.y == data.DisplaySize.y;
    std::vector<List> now;
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        List kept;
        kept.window = list._OwnerName ? list._OwnerName : "";
        kept.vertices.assign(list.VtxBuffer.begin(), list.VtxBuffer.end());
        for (const ImDrawCmd& command : list.CmdBuffer) {
            kept.commands.push_back({command.ClipRect, command.GetTexID()});
            same = same && !command.UserCallback;
            if (command.GetTexID() != changing || !command.ElemCount) continue;
            Box image;
            for (unsigned k = 0; k < command.ElemCount; ++k)
                image.add(list.VtxBuffer[int(list.IdxBuffer[int(command.IdxOffset + k)] + command.VtxOffset)].pos);
            take(image);
        }
        now.push_back(std::move(kept));
        same = same && now.back().window == lists_[size_t(i)].window;
    }
    if (same)
        for (size_t i = 0; i < now.size(); ++i) {
            const List &a = lists_[i], &b = now[i];
            const size_t shorter = std::min(a.vertices.size(), b.vertices.size());
            // Text that changes moves what stands behind it in the list, so both ends are compared.
            size_t front = 0, back = 0;
            bool sameCommands = a.commands.size() == b.commands.size();
            for (size_t c = 0; c < a.commands.size() && sameCommands; ++c)
                sameCommands = a.commands[c].texture == b.commands[c].texture &&
                               std::memcmp(&a.commands[c].clip, &b.commands[c].clip, sizeof(ImVec4)) == 0;
            if (sameCommands) {
                while (front < shorter && sameVertex(a.vertices[front], b.vertices[front])) ++front;
                while (back < shorter - front &&
                       sameVertex(a.vertices[a.vertices.size() - 1 - back], b.vertices[b.vertices.size() - 1 - back]))
                    ++back;
            }
            Box changed;
            addAll(changed, a.vertices.data(), front, a.vertices.size() - back);
            addAll(changed, b.vertices.data(), front, b.vertices.size() - back);
            take(changed);
        }
    lists_ = std::move(now);
    size_ = data.DisplaySize;
    if (!same) return {{{0, 0}, data.DisplaySize}};
    return apart(std::move(parts));
}

}  // namespace relamp::ui
