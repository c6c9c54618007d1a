#include "relight/emitter_sampler.h"

#include <bit>
#include <cmath>

#include "base/random.h"

namespace relamp {

namespace {

constexpr size_t leavesAtMost = 64;
/// Parts whose estimate may be off by less than this fraction of the whole are not cut.
constexpr float enough = 0.01f;
/// A cut serves points that are nearer to its own than this fraction of the distance to the emitter, and normals within
/// this angle.
constexpr float holds = 0.05f, holdsNormal = 0.02f;
/// Steps of a normal's coordinates. Half the diagonal of a step is less than holdsNormal.
constexpr float normalSteps = 64;

/// Values spread evenly over [middle - half, middle + half].
struct Range {
    float middle = 0, half = 0;
    /// Mean of their positive part.
    float meanAbove() const {
        if (middle >= half) return middle;
        return middle <= -half ? 0.0f : (middle + half) * (middle + half) / (4 * half);
    }
    float most() const { return std::max(0.0f, middle + half); }
};

float squaredDistance(const Vec3& point, const std::array<Vec3, 3>& c) {
    const Vec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
    float best = 1e30f;
    bool inside = true;
    for (size_t i = 0; i < 3; ++i) {
        const Vec3 edge = c[(i + 1) % 3] - c[i], to = point - c[i];
        inside &= glm::dot(glm::cross(normal, edge), to) >= 0;
        const float t = std::clamp(glm::dot(to, edge) / std::max(glm::dot(edge, edge), 1e-30f), 0.0f, 1.0f);
        best = std::min(best, glm::dot(to - t * edge, to - t * edge));
    }
    if (!inside) return best;
    const float height = glm::dot(point - c[0], normal);
    return height * height / std::max(glm::dot(normal, normal), 1e-30f);
}

/// Halves of a triangle: the middle of its longest edge is joined to the opposite corner.
struct Halves {
    std::array<Vec3, 3> first, second;
};
Halves halvesOf(const std::array<Vec3, 3>& c) {
    size_t longest = 0;  // the edge from this corner to the next
    float length = -1;
    for (size_t i = 0; i < 3; ++i) {
        const Vec3 edge = c[(i + 1) % 3] - c[i];
        if (glm::dot(edge, edge) > length) length = glm::dot(edge, edge), longest = i;
    }
    const Vec3 &a = c[longest], &b = c[(longest + 1) % 3], &top = c[(longest + 2) % 3];
    const Vec3 middle = 0.5f * (a + b);
    return {{a, middle, top}, {middle, b, top}};
}

}  // namespace

uint32_t EmitterSampler::middleOf(uint32_t begin, uint32_t end) {
    float low[6], high[6];
    std::fill(low, low + 6, 1e30f);
    std::fill(high, high + 6, -1e30f);
    const auto key = [&](uint32_t t, int axis) {
        return axis < 3 ? surface_.centres[t][axis] / std::max(surface_.radius, 1e-20f) : surface_.normals[t][axis - 3];
    };
    for (uint32_t i = begin; i < end; ++i)
        for (int a = 0; a < 6; ++a) {
            low[a] = std::min(low[a], key(order_[i], a));
            high[a] = std::max(high[a], key(order_[i], a));
        }
    int axis = 0;
    for (int a = 1; a < 6; ++a)
        if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    const uint32_t middle = (begin + end) / 2;
    std::nth_element(
        order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
        [&](uint32_t x, uint32_t y) { return key(x, axis) != key(y, axis) ? key(x, axis) < key(y, axis) : x < y; });
    return middle;
}

EmitterSampler::Node EmitterSampler::nodeOf(uint32_t begin, uint32_t end) const {
    Node n;
    n.begin = begin;
    n.end = end;
    Vec3 axis(0);
    for (uint32_t i = begin; i < end; ++i) {
        const uint32_t t = order_[i];
        n.area += surface_.areas[t];
        axis += surface_.areas[t] * surface_.normals[t];
    }
    const float length = glm::length(axis);
    float cosine = 0;
    if (length > 1e-6f * n.area) {
        n.frame = frameAround(axis / length);
        cosine = 1;
        for (uint32_t i = begin; i < end; ++i)
            cosine = std::min(cosine, glm::dot(surface_.normals[order_[i]], n.frame[2]));
    }
    n.coneSine = cosine > 0 ? std::sqrt(std::max(0.0f, 1 - cosine * cosine)) : 2.0f;
    Vec3 low(1e30f), high(-1e30f);
    for (uint32_t i = begin; i < end; ++i)
        for (const Vec3& c : surface_.corners[order_[i]]) {
            low = glm::min(low, c * n.frame);
            high = glm::max(high, c * n.frame);
        }
    n.centre = n.frame * (0.5f * (low + high));
    n.extent = 0.5f * (high - low);
    return n;
}

EmitterSampler::EmitterSampler(const EmitterSurface& surface) : surface_(surface) {
    const uint32_t n = uint32_t(surface.areas.size());
    order_.resize(n);
    placeOf_.resize(n);
    for (uint32_t i = 0; i < n; ++i) order_[i] = i;
    areaBelow_.assign(n + 1, 0);
    if (n == 0) return;
    nodes_.reserve(2 * size_t(n));
    nodes_.push_back({});
    nodes_[0].end = n;
    for (size_t at = 0; at < nodes_.size(); ++at) {
        const uint32_t begin = nodes_[at].begin, end = nodes_[at].end;
        const uint32_t middle = end - begin > 1 ? middleOf(begin, end) : end;
        nodes_[at] = nodeOf(begin, end);
        if (middle == end) continue;
        nodes_[at].child = uint32_t(nodes_.size());
        nodes_.resize(nodes_.size() + 2);
        Node *first = &nodes_[nodes_.size() - 2], *second = &nodes_.back();
        first->begin = begin;
        first->end = second->begin = middle;
        second->end = end;
    }
    for (uint32_t i = 0; i < n; ++i) {
        placeOf_[order_[i]] = i;
        areaBelow_[i + 1] = areaBelow_[i] + double(surface.areas[order_[i]]);
    }
}

void EmitterSampler::estimate(const Proposal& at, Part& p) const {
    const Vec3 &point = at.point, &normal = at.normal;
    // What a piece dA sends: height over the point's horizon x distance from the emitter's plane / r^4.
    Range height, plane;
    float nearest = 0, mean = 0;  // squared distances
    if (p.node != Part::none && p.triangle == Part::none) {
        const Node& n = nodes_[p.node];
        const Vec3 to = n.centre - point, local = to * n.frame;
        const Vec3 outside = glm::max(glm::abs(local) - n.extent, Vec3(0));
        nearest = glm::dot(outside, outside);
        mean = glm::dot(to, to) + glm::dot(n.extent, n.extent) / 3;
        height = {glm::dot(to, normal), glm::dot(n.extent, glm::abs(normal * n.frame))};
        const float far = std::sqrt(glm::dot(to, to)) + glm::length(n.extent);
        plane = n.coneSine > 1 ? Range{0, far} : Range{-local.z, n.extent.z + n.coneSine * far};
    } else {
        const auto& c = p.node == Part::none ? p.corners : surface_.corners[p.triangle];
        const Vec3 centre = (c[0] + c[1] + c[2]) / 3.0f, &axis = surface_.normals[p.triangle];
        float low = 1e30f, high = -1e30f;
        for (const Vec3& corner : c) {
            const float h = glm::dot(corner - point, normal);
            low = std::min(low, h);
            high = std::max(high, h);
            mean += glm::dot(corner - centre, corner - centre) / 12;
        }
        mean += glm::dot(centre - point, centre - point);
        nearest = squaredDistance(point, c);
        height = {0.5f * (low + high), 0.5f * (high - low)};
        plane = {-glm::dot(centre - point, axis), 0};
    }
    if (surface_.twoSided) plane.middle = std::abs(plane.middle);
    // Neighbours share the cut.
    const float slack = holds * std::sqrt(nearest);
    height.half += slack + holdsNormal * std::sqrt(mean);
    plane.half += slack;
    const auto sent = [&](float h, float q, float d2) {
        const float cosines = std::min(1.0f, h * q / std::max(d2, 1e-30f));
        return std::min(pi, p.area * cosines / std::max(d2, 1e-30f));
    };
    const float estimate = sent(height.meanAbove(), plane.meanAbove(), mean);
    const float bound = sent(height.most(), plane.most(), nearest);
    p.weight = std::sqrt(estimate * bound);
    p.error = bound - estimate;
}

void EmitterSampler::cut(const Part& p, Part& first, Part& second) const {
    if (p.node != Part::none && nodes_[p.node].child != Part::none) {
        for (Part* half : {&first, &second}) {
            half->node = nodes_[p.node].child + (half == &second ? 1 : 0);
            const Node& n = nodes_[half->node];
            half->area = n.area;
            if (n.end - n.begin == 1) half->triangle = order_[n.begin];
        }
        return;
    }
    const Halves halves = halvesOf(p.node != Part::none ? surface_.corners[p.triangle] : p.corners);
    first.triangle = second.triangle = p.triangle;
    first.area = second.area = p.area / 2;
    first.corners = halves.first;
    second.corners = halves.second;
}

const EmitterSampler::Proposal* EmitterSampler::prepare(const Vec3& point, const Vec3& normal, Cuts& cuts) const {
    if (nodes_.empty()) return nullptr;
    const Node& root = nodes_[0];
    const Vec3 outside = glm::max(glm::abs((root.centre - point) * root.frame) - root.extent, Vec3(0));
    // A cell's corner is 0.87 of its width from its middle, and the middle may be nearer to the emitter than the point.
    const float widest = 0.9f * holds * glm::length(outside) / 0.87f;
    Vec3 middle = point, facing = normal;
    // Inside the emitter's box each point has a cut of its own.
    if (widest > 1e-6f * surface_.radius) {
        int power = 0;
        std::frexp(widest, &power);
        const float width = std::ldexp(1.0f, power - 1);
        middle = (glm::floor(point / width) + 0.5f) * width;
        facing = glm::normalize(glm::round(normal * normalSteps));
    }
    uint64_t hash = 0;
    for (const float x : {middle.x, middle.y, middle.z, facing.x, facing.y, facing.z})
        hash = mixBits(hash ^ std::bit_cast<uint32_t>(x));
    Proposal& p = cuts.slots_[hash & (cuts.slots_.size() - 1)];
    if (p.point != middle || p.normal != facing) cutFor(middle, facing, p);
    return p.total > 0 ? &p : nullptr;
}

void EmitterSampler::cutFor(const Vec3& point, const Vec3& normal, Proposal& p) const {
    p.point = point;
    p.normal = normal;
    p.parts.clear();
    p.leaves.clear();
    p.heap.clear();
    p.total = 0;
    Part root;
    root.node = 0;
    root.area = nodes_[0].area;
    if (nodes_[0].end == 1) root.triangle = 0;
    estimate(p, root);
    p.parts.push_back(root);
    p.heap.push_back(0);
    const auto lower = [&](uint32_t a, uint32_t b) {
        return p.parts[a].error != p.parts[b].error ? p.parts[a].error < p.parts[b].error : a > b;
    };
    float total = root.weight;
    while (p.heap.size() < leavesAtMost) {
        const uint32_t widest = p.heap.front();
        const float error = p.parts[widest].error;
        if (!(error > enough * total)) break;
        std::pop_heap(p.heap.begin(), p.heap.end(), lower);
        p.heap.pop_back();
        Part first, second;
        cut(p.parts[widest], first, second);
        estimate(p, first);
        estimate(p, second);
        total += first.weight + second.weight - p.parts[widest].weight;
        p.parts[widest].child = uint32_t(p.parts.size());
        for (const Part& half : {first, second}) {
            p.parts.push_back(half);
            p.heap.push_back(uint32_t(p.parts.size() - 1));
            std::push_heap(p.heap.begin(), p.heap.end(), lower);
        }
    }
    // Leaves in the tree's order. The heap is done with and serves as the stack.
    p.heap.assign(1, 0);
    while (!p.heap.empty()) {
        const uint32_t at = p.heap.back();
        p.heap.pop_back();
        Part& part = p.parts[at];
        if (part.child != Part::none) {
            p.heap.push_back(part.child + 1);
            p.heap.push_back(part.child);
        } else if (part.weight > 0) {
            p.total += part.weight;
            part.cumulative = p.total;
            p.leaves.push_back(at);
        }
    }
}

Vec3 EmitterSampler::sample(const Proposal& p, const Vec2& u, float& density, size_t& triangle) const {
    const float pick = u.x * p.total;
    const auto above = std::upper_bound(p.leaves.begin(), p.leaves.end(), pick,
                                        [&](float value, uint32_t leaf) { return value < p.parts[leaf].cumulative; });
    const Part& part = p.parts[above == p.leaves.end() ? p.leaves.back() : *above];
    float inside = std::clamp((pick - (part.cumulative - part.weight)) / part.weight, 0.0f, 0.999999f);
    triangle = part.triangle;
    if (part.triangle == Part::none) {
        const Node& n = nodes_[part.node];
        const double area = areaBelow_[n.begin] + double(inside) * (areaBelow_[n.end] - areaBelow_[n.begin]);
        const auto end = areaBelow_.begin() + n.end;
        const auto next = std::upper_bound(areaBelow_.begin() + n.begin + 1, end, area);
        const size_t place = size_t(next - areaBelow_.begin()) - 1;
        triangle = order_[place];
        const double width = areaBelow_[place + 1] - areaBelow_[place];
        inside = width > 0 ? std::clamp(float((area - areaBelow_[place]) / width), 0.0f, 0.999999f) : 0.5f;
    }
    density = part.weight / p.total / part.area;
    const float root = std::sqrt(inside);
    const auto& c = part.node == Part::none ? part.corners : surface_.corners[triangle];
    return (1 - root) * c[0] + root * (1 - u.y) * c[1] + root * u.y * c[2];
}

float EmitterSampler::areaDensity(const Proposal& p, size_t triangle, const Vec3& point) const {
    if (!(p.total > 0)) return 0;
    uint32_t at = 0;
    while (p.parts[at].child != Part::none) {
        const Part &part = p.parts[at], &second = p.parts[part.child + 1];
        bool inSecond = false;
        if (second.node != Part::none) inSecond = placeOf_[triangle] >= nodes_[second.node].begin;
        else {
            // The halves meet in the line from the first half's middle of the edge to the opposite corner.
            const auto& c = second.corners;
            const Vec3 across = glm::cross(surface_.normals[triangle], c[2] - c[0]);
            inSecond = glm::dot(point - c[0], across) * glm::dot(c[1] - c[0], across) > 0;
        }
        at = part.child + (inSecond ? 1 : 0);
    }
    return p.parts[at].weight / p.total / p.parts[at].area;
}

}  // namespace relamp
