#include "relight/look_track.h"

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json_fields.h"

namespace relamp {
namespace {

/// A = rotation x stretch (polar decomposition, Higham's Newton steps); a mirror stays in the stretch.
void takeApart(const glm::dmat3& a, glm::dquat& rotation, glm::dmat3& stretch) {
    glm::dmat3 q = glm::determinant(a) < 0 ? -a : a;
    const glm::dmat3 whole = q;
    for (int i = 0; i < 40; ++i) {
        const glm::dmat3 next = 0.5 * (q + glm::transpose(glm::inverse(q)));
        double change = 0;
        for (int c = 0; c < 3; ++c) change += glm::length(next[c] - q[c]);
        q = next;
        if (change < 1e-14) break;
    }
    rotation = glm::normalize(glm::quat_cast(q));
    stretch = glm::transpose(q) * (glm::determinant(a) < 0 ? -whole : whole);
}

Mat4 blendMatrices(const Mat4& a, const Mat4& b, double t, const Vec3& pivot) {
    if (a == b) return a;
    glm::dquat turnA, turnB;
    glm::dmat3 stretchA, stretchB;
    takeApart(glm::dmat3(DMat4(a)), turnA, stretchA);
    takeApart(glm::dmat3(DMat4(b)), turnB, stretchB);
    const glm::dmat3 linear = glm::mat3_cast(glm::slerp(turnA, turnB, t)) * ((1 - t) * stretchA + t * stretchB);
    const DVec3 from(DMat4(a) * glm::dvec4(DVec3(pivot), 1)), to(DMat4(b) * glm::dvec4(DVec3(pivot), 1));
    DMat4 m(linear);
    m[3] = glm::dvec4((1 - t) * from + t * to - linear * DVec3(pivot), 1);
    return Mat4(m);
}

template <class T, class Same>
const T* find(const std::vector<T>& list, Same&& same) {
    const auto at = std::find_if(list.begin(), list.end(), same);
    return at == list.end() ? nullptr : &*at;
}

/// Every key calls an emitter what the first key that names it calls it: layers are called the same in all frames.
template <class Emitter>
void sameNames(std::vector<LookKey>& keys, std::vector<Emitter> Look::*emitters, bool everywhere) {
    std::vector<Emitter> named;
    for (const LookKey& key : keys)
        for (const Emitter& e : key.look.*emitters)
            if (!e.name.empty() && !find(named, [&](const Emitter& x) { return x.id == e.id; })) named.push_back(e);
    for (const Emitter& from : named)
        for (LookKey& key : keys) {
            std::vector<Emitter>& list = key.look.*emitters;
            auto at = std::find_if(list.begin(), list.end(), [&](const Emitter& x) { return x.id == from.id; });
            if (at == list.end() && everywhere) {
                at = list.emplace(list.end());
                at->id = from.id;
            }
            if (at != list.end()) at->name = from.name;
        }
}

EmitterLook emitterNamed(const Look& look, const std::string& id) {
    const EmitterLook* e = find(look.emitters, [&](const EmitterLook& x) { return x.id == id; });
    if (e) return *e;
    EmitterLook as;
    as.id = id;
    return as;
}

Mat4 partMatrix(const Look& look, uint32_t seed) {
    const PartLook* p = find(look.parts, [&](const PartLook& x) { return x.seedVertex == seed; });
    return p ? p->matrix : Mat4(1);
}

/// A part goes with the emitter it is attached to, or with one that has the same movement.
Vec3 pivotOfPart(const PartLook& part, const Look& a, const Look& b, const std::vector<EmitterLook>& emitters,
                 const LookPivots& pivots) {
    if (!part.attachedTo.empty() && find(emitters, [&](const EmitterLook& e) { return e.id == part.attachedTo; }))
        return pivots.emitter(part.attachedTo);
    for (const EmitterLook& e : emitters)
        if (emitterNamed(a, e.id).matrix == partMatrix(a, part.seedVertex) &&
            emitterNamed(b, e.id).matrix == partMatrix(b, part.seedVertex))
            return pivots.emitter(e.id);
    return pivots.vertex(part.seedVertex);
}

/// The recovered environment goes evenly from one lighting state, or mix of two, to another.
void blendStates(const EnvironmentLook& to, float t, EnvironmentLook& from) {
    const auto plain = [](const EnvironmentLook& look) { return look.mixState.empty() || look.mix == 0; };
    if (from.state == to.state && (plain(from) || plain(to) || from.mixState == to.mixState)) {
        const float before = plain(from) ? 0.0f : from.mix, after = plain(to) ? 0.0f : to.mix;
        if (plain(from)) from.mixState = to.mixState;
        from.mix = before + t * (after - before);
    } else if (plain(from) && plain(to)) {
        // A mix goes to a state that is named.
        const bool there = !to.state.empty();
        from.mixState = there ? to.state : from.state;
        if (!there) from.state = to.state;
        from.mix = there ? t : 1 - t;
    }
}

}  // namespace

Rgb blendLight(const Rgb& a, const Rgb& b, float t) {
    Rgb out;
    for (int c = 0; c < 3; ++c)
        out[c] = a[c] > 0 && b[c] > 0 ? std::exp2((1 - t) * std::log2(a[c]) + t * std::log2(b[c]))
                                      : (1 - t) * a[c] + t * b[c];
    return out;
}

Look blendLooks(const Look& a, const Look& b, float t, const LookPivots& pivots) {
    if (t <= 0) return a;
    if (t >= 1) return b;
    Look out = a;
    EnvironmentLook& environment = out.environment;
    if (environment.source == EnvironmentLook::Source::recovered && b.environment.source == environment.source)
        blendStates(b.environment, t, environment);
    environment.yawDegrees += t * (b.environment.yawDegrees - a.environment.yawDegrees);
    environment.exposureStops += t * (b.environment.exposureStops - a.environment.exposureStops);
    environment.tint = blendLight(a.environment.tint, b.environment.tint, t);
    for (size_t k = 0; k < environment.sides.size(); ++k)
        environment.sides[k] = blendLight(a.environment.sides[k], b.environment.sides[k], t);
    for (const EmitterLook& e : b.emitters)
        if (!find(out.emitters, [&](const EmitterLook& x) { return x.id == e.id; }))
            out.emitters.push_back(emitterNamed(a, e.id));
    for (EmitterLook& e : out.emitters) {
        const EmitterLook other = emitterNamed(b, e.id);
        e.matrix = blendMatrices(e.matrix, other.matrix, t, pivots.emitter(e.id));
        if (e.enabled || other.enabled) {
            e.powerScale = blendLight(e.enabled ? e.powerScale : Rgb(0), other.enabled ? other.powerScale : Rgb(0), t);
            e.enabled = true;
        }
    }
    for (AddedEmitter& e : out.added) {
        const AddedEmitter* other = find(b.added, [&](const AddedEmitter& x) { return x.id == e.id; });
        if (!other || other->shape != e.shape) continue;
        const auto geometry = infoOf(e.shape).geometry;
        const Vec3 pivot = geometry == EmitterShapeInfo::Geometry::component ? pivots.vertex(e.seedVertex)
                           : geometry == EmitterShapeInfo::Geometry::emitter ? pivots.emitter(e.source)
                                                                             : Vec3(0);
        e.matrix = blendMatrices(e.matrix, other->matrix, t, pivot);
        e.size += t * (other->size - e.size);
        e.shaping = blendShapings(e.shaping, other->shaping, t);
        if (e.enabled || other->enabled) {
            e.radiance = blendLight(e.enabled ? e.radiance : Rgb(0), other->enabled ? other->radiance : Rgb(0), t);
            e.enabled = true;
        }
    }
    for (LightGroup& g : out.groups) {
        const LightGroup* other = find(b.groups, [&](const LightGroup& x) { return x.name == g.name; });
        if (!other || !(g.enabled || other->enabled)) continue;
        g.powerScale = blendLight(g.enabled ? g.powerScale : Rgb(0), other->enabled ? other->powerScale : Rgb(0), t);
        g.enabled = true;
    }
    for (const PartLook& p : b.parts)
        if (!find(out.parts, [&](const PartLook& x) { return x.seedVertex == p.seedVertex; }))
            out.parts.push_back({p.seedVertex, Mat4(1), p.attachedTo});
    for (PartLook& p : out.parts)
        p.matrix = blendMatrices(p.matrix, partMatrix(b, p.seedVertex), t, pivotOfPart(p, a, b, out.emitters, pivots));
    return out;
}

LookTrack::LookTrack(Look look) {
    look.plate.reset();  // it is relit, and is no light
    look.bookmarks.clear();
    curves_ = std::exchange(look.curves, {});
    if (look.keys.empty()) keys_.push_back({1, std::move(look), KeyEase::linear});
    else keys_ = LookTrack(std::move(look.keys)).keys_;
}

LookTrack::LookTrack(std::vector<LookKey> keys) : keys_(std::move(keys)) {
    if (keys_.empty()) throw Error("keys: is empty, expected a look");
    std::sort(keys_.begin(), keys_.end(), [](const LookKey& a, const LookKey& b) { return a.frame < b.frame; });
    for (size_t i = 1; i < keys_.size(); ++i)
        if (keys_[i].frame == keys_[i - 1].frame) throw Error("keys: frame {} has two looks", keys_[i].frame);
    sameNames(keys_, &Look::emitters, true);
    sameNames(keys_, &Look::added, false);
}

bool LookTrack::moves() const {
    return keys_.size() > 1 ||
           std::any_of(curves_.begin(), curves_.end(), [](const ValueCurve& curve) { return curve.keys.size() > 1; });
}

Look LookTrack::at(int frame, const LookPivots& pivots) const {
    Look look = betweenKeys(frame, pivots);
    for (const ValueCurve& curve : curves_) setValue(look, curve.what, valueAt(curve, frame), pivots);
    return look;
}

Look LookTrack::betweenKeys(int frame, const LookPivots& pivots) const {
    if (frame <= keys_.front().frame) return keys_.front().look;
    for (size_t i = 1; i < keys_.size(); ++i) {
        const LookKey &a = keys_[i - 1], &b = keys_[i];
        if (frame > b.frame) continue;
        if (frame == b.frame) return b.look;
        const float t = float(frame - a.frame) / float(b.frame - a.frame);
        return blendLooks(a.look, b.look, eased(a.ease, t), pivots);
    }
    return keys_.back().look;
}

void LookTrack::apply(const std::function<void(Look&)>& change) {
    // A key's value is changed as the look's own would be.
    for (ValueCurve& curve : curves_)
        for (ValueKey& key : curve.keys) {
            Look look = keys_.front().look;
            setValue(look, curve.what, key.value, {});
            const std::optional<Vec3> before = valueOf(look, curve.what, {});
            change(look);
            if (const std::optional<Vec3> now = valueOf(look, curve.what, {}); now && before && *now != *before)
                key.value += *now - *before;
        }
    for (LookKey& key : keys_) change(key.look);
}

LookTrack readLookTrack(const std::filesystem::path& file, const DVec3& origin) {
    return LookTrack(readLook(file, origin));
}

}  // namespace relamp
