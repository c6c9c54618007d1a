#include "relight/live/matte.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/box.h"
#include "base/morton.h"
#include "base/parallel.h"

namespace relamp {
namespace {

constexpr uint32_t none = EditedPart::none;

/// Never the same again, so that two scenes have none in common.
uint64_t newVersion() {
    static std::atomic<uint64_t> last = 0;
    return ++last;
}

}  // namespace

TransportBlock LiveMatte::bakeBlock(size_t block, const LiveVertices& vertices, const LiveOccluders& occluders) {
    const Occluded8 ground = [&](std::span<const Ray> rays) { return occluders.groundOccluded8(rays); };
    thread_local std::vector<float> cells;
    cells.resize(transportLanes * grid_.cells());
    for (size_t lane = 0; lane < transportLanes; ++lane) {
        const size_t slot = block * transportLanes + lane;
        const std::span<float> own = std::span(cells).subspan(lane * grid_.cells(), grid_.cells());
        if (vertexOfSlot_[slot] == none) {
            std::fill(own.begin(), own.end(), 0.0f);
            continue;
        }
        const Vec3 position = vertices.mesh->positions[vertexOfSlot_[slot]];
        traceCells(grid_, occluders.origin(position, normal_[slot]), normal_[slot], false, ground, masksOf(slot));
        grid_.weights(normal_[slot], masksOf(slot), own);
    }
    return packTransport(cells, tests_, error_);
}

uint64_t LiveMatte::keyOf(const LiveVertices& vertices, const LiveOccluders& occluders) const {
    constexpr uint64_t bakeVersion = 1;  // of what is traced and packed: to be raised with every change of its answer
    const Mesh& mesh = *vertices.mesh;
    ByteSum sum;
    sum.add(bakeVersion);
    sum.add(int32_t(grid_.grid().side));
    sum.add(error_);
    sum.add(occluders.offset);
    sum.addAll(tests_.spread());
    for (const std::vector<float>& coefs : tests_.coefs()) sum.addAll(coefs);
    sum.addAll(vertexOfSlot_);
    // Emitters and other movable parts are not part of it: where they stand changes nothing.
    for (const uint32_t v : vertexOfSlot_)
        if (v != none) {
            sum.add(&mesh.positions[v], sizeof(Vec3));
            sum.add(&mesh.normals[v], sizeof(Vec3));
        }
    for (const Triangle& t : mesh.triangles)
        if (vertices.kind[t[0]] == LiveVertices::ground) sum.add(t.data(), sizeof(Triangle));
    return sum.value();
}

size_t LiveMatte::bake(const LiveVertices& vertices, const LiveOccluders& occluders,
                       const std::filesystem::path& cacheFolder, Progress& progress) {
    const Mesh& mesh = *vertices.mesh;
    Box box;
    std::vector<uint32_t> order;
    for (uint32_t v = 0; v < vertices.count(); ++v) {
        if (vertices.kind[v] != LiveVertices::ground) continue;
        order.push_back(v);
        box.grow(mesh.positions[v]);
    }
    // Vertices of like normals together first: they need the same terms. Then along a curve through space.
    std::vector<uint64_t> key(vertices.count());
    const Vec3 size = glm::max(box.size(), Vec3(1e-20f));
    const DirectionGrid coarse{4};
    for (uint32_t v : order)
        key[v] = uint64_t(coarse.cellOf(mesh.normals[v])) << 32 | mortonKey((mesh.positions[v] - box.min) / size);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
    vertexOfSlot_ = order;
    vertexOfSlot_.resize((order.size() + transportLanes - 1) / transportLanes * transportLanes, none);
    slotOfVertex_.assign(vertices.count(), none);
    normal_.assign(slots(), Vec3(0, 0, 1));
    weightScale_.assign(slots(), 0);
    for (uint32_t s = 0; s < order.size(); ++s) {
        slotOfVertex_[order[s]] = s;
        normal_[s] = mesh.normals[order[s]];
    }
    masks_.assign(slots() * grid_.nibbleBytes(), 0);
    slotsVersion_ = newVersion();
    remasked_ = false;
    base_.assign(slots(), Rgb(0));
    freed_.assign(chunks(), {});
    corrections_.assign(chunks(), {});
    combine_.assign(chunks(), 0);
    changed_.assign(chunks(), 0);
    told_.assign(chunks(), 0);
    const size_t blocks = slots() / transportLanes;
    stale_.assign(blocks, 0);
    std::vector<TransportBlock> packed(blocks);
    progress.begin("Transport of the environment", order.size());
    const size_t maskBytes = transportLanes * grid_.nibbleBytes();
    TransportCache::Layout layout{0, uint32_t(grid_.grid().side), blocks, uint32_t(maskBytes)};
    if (!cacheFolder.empty()) layout.key = keyOf(vertices, occluders);
    TransportCache cache(cacheFolder, layout);
    const size_t found = parallelSum(layout.chunks(), 1, size_t(0), [&](size_t begin, size_t end) {
        size_t own = 0;
        for (size_t chunk = begin; chunk < end; ++chunk) {
            const size_t first = chunk * TransportCache::blocksPerChunk, count = layout.blocksOf(chunk);
            const std::span<TransportBlock> place = std::span(packed).subspan(first, count);
            const std::span<uint8_t> masks = std::span(masks_).subspan(first * maskBytes, count * maskBytes);
            const bool known = cache.load(chunk, masks, place);
            for (size_t b = first; b < first + count; ++b) {
                if (!known) packed[b] = bakeBlock(b, vertices, occluders);
                for (size_t s = b * transportLanes; s < (b + 1) * transportLanes; ++s)
                    weightScale_[s] = grid_.weightScale(normal_[s]);
                progress.advance(std::min(transportLanes, order.size() - b * transportLanes));
            }
            if (known) own += count;
            else cache.store(chunk, masks, place);
        }
        return own;
    });
    store_ = TransportStore(std::move(packed));
    return found;
}

size_t LiveMatte::bytes() const {
    size_t sum = store_.bytes() + masks_.size() + normal_.size() * sizeof(Vec3);
    for (const Shadow& s : shadows_)
        for (const CellLists& l : s.lists)
            sum += l.entries.size() * sizeof(uint16_t) + l.start.size() * sizeof(uint32_t);
    for (const Correction& c : corrections_)
        sum += c.cell.size() * (sizeof(uint16_t) + sizeof(float)) + c.start.size() * sizeof(uint32_t);
    return sum;
}

void LiveMatte::setParts(const std::vector<std::string>& names) {
    std::vector<Shadow> shadows(names.size());
    for (size_t b = 1; b < names.size(); ++b) {
        for (Shadow& old : shadows_)
            if (old.name == names[b]) {
                shadows[b] = std::exchange(old, {});
                break;
            }
        shadows[b].name = names[b];
        if (shadows[b].lists.empty()) {
            shadows[b].lists.assign(chunks(), {});
            shadows[b].level.assign(chunks(), 0);
            shadows[b].clear.assign(chunks() * run, 0);
        }
    }
    for (Shadow& gone : shadows_)
        if (!gone.name.empty())
            for (size_t c = 0; c < gone.lists.size(); ++c)
                if (!gone.lists[c].entries.empty()) combine_[c] = 1;
    shadows_ = std::move(shadows);
}

void LiveMatte::markMoved(size_t part) {
    std::fill(shadows_[part].level.begin(), shadows_[part].level.end(), uint8_t(0));
}

void LiveMatte::release(const LiveVertices& vertices, const LiveOccluders& occluders, const LivePart& gone,
                        Progress& progress) {
    slotOfVertex_.resize(std::max(slotOfVertex_.size(), vertices.count()), none);
    for (uint32_t s = 0; s < slots(); ++s)
        if (vertexOfSlot_[s] != none && vertices.kind[vertexOfSlot_[s]] != LiveVertices::ground) {
            slotOfVertex_[vertexOfSlot_[s]] = none;
            vertexOfSlot_[s] = none;
        }
    slotsVersion_ = newVersion();
    remasked_ = true;
    // Not blocked by what is left of the ground.
    const Occluded8 open = [&](std::span<const Ray> rays) { return ~occluders.groundOccluded8(rays); };
    parallelFor(chunks(), 1, [&](size_t c) {
        CellLists fresh;
        fresh.clear(run);
        std::vector<uint8_t> hidden(grid_.nibbleBytes());
        std::vector<uint16_t> own;
        for (size_t i = 0; i < run; ++i) {
            const size_t s = c * run + i;
            own.clear();
            if (s < slots() && vertexOfSlot_[s] != none) {
                Vec3 axis;
                float angle;
                const Vec3 position = vertices.mesh->positions[vertexOfSlot_[s]];
                gone.cone(position, axis, angle);
                const std::span<uint8_t> masks = masksOf(s);
                std::fill(hidden.begin(), hidden.end(), uint8_t(0));
                grid_.cellsInCone(axis, angle, [&](size_t cell) {
                    unsigned above = 0;
                    for (int q = 0; q < 4; ++q)
                        if (glm::dot(grid_.quarter(cell, q), normal_[s]) > 0) above |= 1u << q;
                    setNibble(hidden.data(), cell, above & ~nibbleOf(masks.data(), cell));
                });
                traceCone(grid_, occluders.origin(position, normal_[s]), normal_[s], axis, angle, hidden, true, open,
                          own);
                if (!own.empty()) stale_[s / transportLanes] = 1;
                for (const uint16_t e : own)
                    setNibble(masks.data(), e >> 4, nibbleOf(masks.data(), e >> 4) | (e & 15u));
            }
            const std::span<const uint16_t> before = freed_[c].of(i);
            fresh.entries.insert(fresh.entries.end(), before.begin(), before.end());
            fresh.entries.insert(fresh.entries.end(), own.begin(), own.end());
            fresh.start[i + 1] = uint32_t(fresh.entries.size());
        }
        if (fresh.entries.size() != freed_[c].entries.size()) {
            freed_[c] = std::move(fresh);
            combine_[c] = 1;
            for (Shadow& shadow : shadows_)
                if (!shadow.level.empty()) shadow.level[c] = 0;
        }
    });
    progress.check();
}

bool LiveMatte::missed(size_t chunk, const LiveVertices& vertices, const Gaze& gaze) const {
    for (size_t s = chunk * run; s < std::min((chunk + 1) * run, slots()); ++s)
        if (vertexOfSlot_[s] != none && !gaze.misses(vertices.mesh->positions[vertexOfSlot_[s]], normal_[s]))
            return false;
    return true;
}

void LiveMatte::traceShadow(Shadow& shadow, size_t chunk, Rays density, const LiveVertices& vertices,
                            const LiveOccluders& occluders, const LivePart& part) {
    const bool coarse = density != Rays::quarter, shared = density == Rays::shared;
    CellLists& lists = shadow.lists[chunk];
    const bool had = !lists.entries.empty();
    thread_local std::vector<uint16_t> before;
    before.assign(lists.entries.begin(), lists.entries.end());
    lists.clear(run);
    const Occluded8 occluded = [&](std::span<const Ray> rays) { return part.occluded8(rays); };
    thread_local ConeAnswers answers;
    answers.angle = -1;
    for (size_t i = 0; i < run; ++i) {
        const size_t s = chunk * run + i;
        shadow.clear[s] = 0;
        if (s < slots() && vertexOfSlot_[s] != none && part.tracer) {
            Vec3 axis;
            float angle;
            const Vec3 position = vertices.mesh->positions[vertexOfSlot_[s]];
            part.cone(position, axis, angle);
            const Vec3 origin = occluders.origin(position, normal_[s]);
            bool whole = false;
            if (!shared || !coneFromAnswers(grid_, normal_[s], axis, angle, masksOf(s), answers, lists.entries, whole))
                whole = traceCone(grid_, origin, normal_[s], axis, angle, masksOf(s), coarse, occluded, lists.entries,
                                  shared ? &answers : nullptr);
            shadow.clear[s] = whole;
        }
        lists.start[i + 1] = uint32_t(lists.entries.size());
    }
    noteShadow(shadow, chunk, coarse ? 1 : 2, had, before);
}

void LiveMatte::noteShadow(Shadow& shadow, size_t chunk, uint8_t level, bool had, std::span<const uint16_t> before) {
    const std::vector<uint16_t>& now = shadow.lists[chunk].entries;
    shadow.level[chunk] = level;
    if ((had || !now.empty()) && !std::equal(before.begin(), before.end(), now.begin(), now.end())) combine_[chunk] = 1;
}

bool LiveMatte::bakeStale(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress) {
    progress.check();
    std::vector<uint32_t> blocks;
    for (uint32_t b = 0; b < stale_.size() && blocks.size() < 128; ++b)
        if (stale_[b]) blocks.push_back(b);
    if (blocks.empty()) return false;
    std::vector<std::pair<uint32_t, TransportBlock>> fresh(blocks.size());
    parallelFor(blocks.size(), 1, [&](size_t i) { fresh[i] = {blocks[i], bakeBlock(blocks[i], vertices, occluders)}; });
    store_.replace(fresh);
    slotsVersion_ = newVersion();
    remasked_ = true;
    for (uint32_t b : blocks) {
        stale_[b] = 0;
        const size_t c = b * transportLanes / run;
        CellLists kept;
        kept.clear(run);
        for (size_t i = 0; i < run; ++i) {
            if ((c * run + i) / transportLanes != b) {
                const auto own = freed_[c].of(i);
                kept.entries.insert(kept.entries.end(), own.begin(), own.end());
            }
            kept.start[i + 1] = uint32_t(kept.entries.size());
        }
        freed_[c] = kept.entries.empty() ? CellLists{} : std::move(kept);
        combine_[c] = 1;
        for (Shadow& shadow : shadows_)
            if (!shadow.level.empty()) shadow.level[c] = std::min<uint8_t>(shadow.level[c], 1);
    }
    rebaked_ = true;
    return true;
}

bool LiveMatte::refine(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress) {
    progress.check();
    std::vector<uint32_t> wanted;
    for (uint32_t c = 0; c < chunks() && wanted.size() < 64; ++c)
        for (size_t b = 1; b < shadows_.size(); ++b)
            if (shadows_[b].level[c] < 2) {
                wanted.push_back(c);
                break;
            }
    if (wanted.empty()) return false;
    parallelFor(wanted.size(), 1, [&](size_t i) {
        for (size_t b = 1; b < shadows_.size(); ++b)
            if (shadows_[b].level[wanted[i]] < 2)
                traceShadow(shadows_[b], wanted[i], Rays::quarter, vertices, occluders, occluders.parts[b]);
    });
    return true;
}

void LiveMatte::combine(size_t c) {
    Correction& out = corrections_[c];
    out.start.assign(run + 1, 0);
    out.cell.clear();
    out.weight.clear();
    thread_local std::vector<uint8_t> blocked, freed;
    thread_local std::vector<uint16_t> touched;
    blocked.assign(grid_.cells(), 0);
    freed.assign(grid_.cells(), 0);
    for (size_t i = 0; i < run; ++i) {
        const size_t s = c * run + i;
        if (s < slots() && vertexOfSlot_[s] != none) {
            touched.clear();
            for (const uint16_t e : freed_[c].of(i)) {
                if (!freed[e >> 4]) touched.push_back(uint16_t(e >> 4));
                freed[e >> 4] |= uint8_t(e & 15);
            }
            for (size_t b = 1; b < shadows_.size(); ++b)
                for (const uint16_t e : shadows_[b].lists[c].of(i)) {
                    if (!freed[e >> 4] && !blocked[e >> 4]) touched.push_back(uint16_t(e >> 4));
                    blocked[e >> 4] |= uint8_t(e & 15);
                }
            for (const uint16_t cell : touched) {
                // All that parts block was seen: masks are looked up only where that may have changed.
                const unsigned seen = remasked_ ? nibbleOf(masksOf(s).data(), cell) : blocked[cell],
                               baked = seen & ~unsigned(freed[cell]), now = seen & ~unsigned(blocked[cell]);
                const float weight = grid_.weightOf(normal_[s], cell, now & ~baked, weightScale_[s]) -
                                     grid_.weightOf(normal_[s], cell, baked & ~now, weightScale_[s]);
                blocked[cell] = freed[cell] = 0;
                if (weight == 0) continue;
                out.cell.push_back(cell);
                out.weight.push_back(weight);
            }
        }
        out.start[i + 1] = uint32_t(out.cell.size());
    }
    combine_[c] = 0;
    changed_[c] = 1;
    told_[c] = 1;
}

void LiveMatte::apply(const LiveLight& light, bool all, std::span<Rgb> out) {
    if (all || rebaked_) sums_.apply(store_, light.coefs, base_);
    all |= rebaked_;
    rebaked_ = false;
    parallelFor(chunks(), 8, [&](size_t c) {
        if (combine_[c]) combine(c);
        if (!all && !changed_[c]) return;
        changed_[c] = 0;
        const Correction& k = corrections_[c];
        for (size_t i = 0; i < run; ++i) {
            const size_t s = c * run + i;
            if (s >= slots() || vertexOfSlot_[s] == none) continue;
            Rgb sum = base_[s];
            if (!k.start.empty())
                for (uint32_t e = k.start[i]; e < k.start[i + 1]; ++e) sum += k.weight[e] * light.cells[k.cell[e]];
            out[vertexOfSlot_[s]] = glm::max(sum, Rgb(0));
        }
    });
}

bool LiveMatte::groundClear(size_t part, size_t vertex) const {
    const uint32_t s = vertex < slotOfVertex_.size() ? slotOfVertex_[vertex] : none;
    return s != none && part < shadows_.size() && !shadows_[part].level.empty() && shadows_[part].level[s / run] &&
           shadows_[part].clear[s];
}

void LiveMatte::seenNow(uint32_t vertex, std::span<uint8_t> masks) const {
    const uint32_t s = slotOfVertex_[vertex];
    if (s == none) {
        std::fill(masks.begin(), masks.end(), uint8_t(0));
        return;
    }
    const std::span<const uint8_t> own = masksOf(s);
    std::copy(own.begin(), own.end(), masks.begin());
    for (size_t b = 1; b < shadows_.size(); ++b)
        for (const uint16_t e : shadows_[b].lists[s / run].of(s % run))
            setNibble(masks.data(), e >> 4, nibbleOf(masks.data(), e >> 4) & ~unsigned(e & 15));
}

std::vector<uint32_t> LiveMatte::takeChanged() {
    std::vector<uint32_t> vertices;
    for (size_t c = 0; c < chunks(); ++c) {
        if (!told_[c]) continue;
        told_[c] = 0;
        for (size_t s = c * run; s < std::min((c + 1) * run, slots()); ++s)
            if (vertexOfSlot_[s] != none) vertices.push_back(vertexOfSlot_[s]);
    }
    return vertices;
}

}  // namespace relamp
