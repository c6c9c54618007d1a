// The first samples of parts' shadows: from a device where there is one, else traced here.
#include <chrono>
#include <utility>

#include "base/parallel.h"
#include "relight/live/matte.h"

namespace relamp {

bool LiveMatte::whollyStale(size_t part, const LiveOccluders& occluders) const {
    const std::vector<uint8_t>& level = shadows_[part].level;
    return occluders.parts[part].tracer && std::all_of(level.begin(), level.end(), [](uint8_t l) { return l == 0; });
}

ShadowQuery LiveMatte::queryOf(uint32_t part, const LiveVertices& vertices, const LiveOccluders& occluders,
                               const DeviceBlockers& blockers) const {
    return {grid_, vertexOfSlot_, normal_, masks_, slotsVersion_, vertices, occluders, blockers, part};
}

void LiveMatte::start(const LiveVertices& vertices, const LiveOccluders& occluders, const DeviceBlockers& blockers) {
    started_.clear();
    place_.forget();
    if (!place_.open() || !place_.measured() || !chunks()) return;
    for (uint32_t b = 1; b < shadows_.size(); ++b)
        if (whollyStale(b, occluders) && place_.start(queryOf(b, vertices, occluders, blockers))) started_.push_back(b);
}

void LiveMatte::takeAnswers(Shadow& shadow, const ShadowAnswers& answers) {
    parallelFor(chunks(), 4, [&](size_t c) {
        if (answers.first[c] == ShadowAnswers::none) return;
        CellLists& lists = shadow.lists[c];
        thread_local std::vector<uint16_t> before;
        before.assign(lists.entries.begin(), lists.entries.end());
        lists.clear(run);
        size_t at = answers.first[c];
        for (size_t i = 0; i < run; ++i) {
            const size_t s = c * run + i;
            const uint32_t word = s < slots() ? answers.slot[s] : 0, count = word & ~ShadowAnswers::whole;
            const auto first = answers.entries.begin() + long(at);
            lists.entries.insert(lists.entries.end(), first, first + count);
            lists.start[i + 1] = uint32_t(lists.entries.size());
            shadow.clear[s] = (word & ShadowAnswers::whole) != 0;
            at += (count + 1) / 2 * 2;
        }
        noteShadow(shadow, c, 1, !before.empty(), before);
    });
}

void LiveMatte::coarse(const LiveVertices& vertices, const LiveOccluders& occluders, const DeviceBlockers& blockers,
                       const Gaze& gaze, Progress& progress) {
    slotOfVertex_.resize(std::max(slotOfVertex_.size(), vertices.count()), EditedPart::none);
    for (const uint32_t b : std::exchange(started_, {}))
        if (const ShadowAnswers* answers = place_.finish()) takeAnswers(shadows_[b], *answers);
    for (uint32_t b = 1; b < shadows_.size() && place_.open() && !place_.measured() && chunks(); ++b) {
        if (!whollyStale(b, occluders)) continue;
        Shadow& own = shadows_[b];
        const auto begin = std::chrono::steady_clock::now();
        parallelFor(chunks(), 1,
                    [&](size_t c) { traceShadow(own, c, Rays::cell, vertices, occluders, occluders.parts[b]); });
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
        progress.check();
        place_.measure(queryOf(b, vertices, occluders, blockers), took.count(), [&](const ShadowAnswers& answers) {
            Shadow other = own;
            const std::vector<uint8_t> combine = combine_;
            takeAnswers(other, answers);
            combine_ = combine;
            size_t same = 0;
            for (size_t s = 0; s < slots(); ++s)
                same += std::ranges::equal(own.lists[s / run].of(s % run), other.lists[s / run].of(s % run));
            return double(same) / double(slots());
        });
    }
    const Rays rays = slots() < manySlots ? Rays::cell : Rays::shared;
    parallelFor(chunks(), 1, [&](size_t c) {
        bool any = false, traced = true;
        for (size_t b = 1; b < shadows_.size(); ++b) {
            any |= !shadows_[b].level[c];
            traced &= !shadows_[b].lists[c].start.empty();
        }
        if (!any || (traced && missed(c, vertices, gaze))) return;
        for (size_t b = 1; b < shadows_.size(); ++b)
            if (!shadows_[b].level[c]) traceShadow(shadows_[b], c, rays, vertices, occluders, occluders.parts[b]);
    });
    progress.check();
}

}  // namespace relamp
