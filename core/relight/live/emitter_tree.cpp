#include "relight/live/emitter_tree.h"

#include <numeric>

#include "base/box.h"

namespace relamp {
namespace {

/// Whether every corner lies behind every triangle.
bool isConvex(const EmitterSurface& s) {
    if (s.corners.size() > 4000) return false;
    const float slack = 1e-3f * s.radius;
    for (size_t t = 0; t < s.corners.size(); ++t)
        for (const auto& other : s.corners)
            for (const Vec3& p : other)
                if (glm::dot(p - s.centres[t], s.normals[t]) > slack) return false;
    return !s.corners.empty();
}

}  // namespace

LiveEmitterTree::LiveEmitterTree(EmitterSurface surface, std::optional<bool> convex) : surface_(std::move(surface)) {
    order_.resize(surface_.corners.size());
    std::iota(order_.begin(), order_.end(), 0u);
    if (order_.empty()) return;
    nodes_.reserve(2 * order_.size());
    build(0, uint32_t(order_.size()));
    float sum = 0;
    cumulative_.reserve(order_.size());
    for (uint32_t t : order_) cumulative_.push_back(sum += surface_.areas[t]);
    convex_ = convex ? *convex : !surface_.twoSided && isConvex(surface_);
}

uint32_t LiveEmitterTree::build(uint32_t begin, uint32_t end) {
    const uint32_t at = uint32_t(nodes_.size());
    nodes_.emplace_back();
    Node n;
    n.begin = begin;
    n.end = end;
    Box places, normals;
    for (uint32_t i = begin; i < end; ++i) {
        const uint32_t t = order_[i];
        n.area += surface_.areas[t];
        n.centre += surface_.areas[t] * surface_.centres[t];
        n.vectorArea += surface_.areas[t] * surface_.normals[t];
        places.grow(surface_.centres[t]);
        normals.grow(surface_.normals[t]);
    }
    n.centre /= n.area;
    const float length = glm::length(n.vectorArea);
    if (length > 1e-6f * n.area) {
        n.axis = n.vectorArea / length;
        n.coneCosine = 1;
        for (uint32_t i = begin; i < end; ++i)
            n.coneCosine = std::min(n.coneCosine, glm::dot(n.axis, surface_.normals[order_[i]]));
        n.coneSine = std::sqrt(std::max(0.0f, 1 - n.coneCosine * n.coneCosine));
    }
    for (uint32_t i = begin; i < end; ++i)
        n.radius = std::max(n.radius, glm::length(surface_.centres[order_[i]] - n.centre) + surface_.radii[order_[i]]);
    if (end - begin > 1) {
        // Along the wider of place and orientation: the two faces of a thin emitter are parted first.
        const Vec3 size = places.size() / std::max(surface_.radius, 1e-20f), turn = normals.size();
        const auto widest = [](const Vec3& e) { return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2; };
        const int place = widest(size), way = widest(turn);
        const bool byNormal = turn[way] > std::max(0.3f, size[place]);
        const auto key = [&](uint32_t t) { return byNormal ? surface_.normals[t][way] : surface_.centres[t][place]; };
        const auto less = [&](uint32_t a, uint32_t b) {
            const float x = key(a), y = key(b);
            return x != y ? x < y : a < b;
        };
        uint32_t middle = (begin + end) / 2;
        if (byNormal) {
            const float half = normals.centre()[way];
            middle = uint32_t(std::partition(order_.begin() + begin, order_.begin() + end,
                                             [&](uint32_t t) { return surface_.normals[t][way] < half; }) -
                              order_.begin());
        }
        if (!byNormal || middle == begin || middle == end) {
            middle = (begin + end) / 2;
            std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, less);
        }
        build(begin, middle);
        n.right = build(middle, end);
    }
    nodes_[at] = n;
    return at;
}

void LiveEmitterTree::cut(const Vec3& point, const Vec3& normal, const CutTolerance& tolerance,
                          EmitterComponents& out) const {
    cut(
        point, normal, tolerance, [](const Vec3&) { return 1e30f; }, out);
}

Vec3 LiveEmitterTree::pointOn(const EmitterComponents::Piece& component, const Vec2& u, Vec3& normal) const {
    const std::array<Vec3, 3>* c = &component.corners;
    float inside = u.x;
    if (component.begin != component.end) {
        const float before = component.begin ? cumulative_[component.begin - 1] : 0.0f;
        const float pick = before + u.x * (cumulative_[component.end - 1] - before);
        const auto first = cumulative_.begin() + component.begin, last = cumulative_.begin() + component.end;
        const auto place = std::min(std::upper_bound(first, last, pick), last - 1);
        const uint32_t i = uint32_t(place - cumulative_.begin());
        const float below = i ? cumulative_[i - 1] : 0.0f, width = cumulative_[i] - below;
        inside = width > 0 ? std::clamp((pick - below) / width, 0.0f, 0.999999f) : 0.5f;
        c = &surface_.corners[order_[i]];
        normal = surface_.normals[order_[i]];
    } else {
        normal = glm::normalize(glm::cross((*c)[1] - (*c)[0], (*c)[2] - (*c)[0]));
    }
    const float root = std::sqrt(inside);
    return (1 - root) * (*c)[0] + root * (1 - u.y) * (*c)[1] + root * u.y * (*c)[2];
}

}  // namespace relamp
