#include "solve/solve_checkpoint.h"

#include <cstring>
#include <type_traits>

#include "base/random.h"

namespace relamp {
namespace {

/// Fields in order, either way: the same function writes and reads them, so that the two cannot part.
class FieldWriter {
public:
    std::string bytes;
    template <class T>
    void plain(T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    size_t count(size_t present) {
        uint64_t n = present;
        plain(n);
        return present;
    }
    void block(void* data, size_t size) { bytes.append(static_cast<const char*>(data), size); }
    static constexpr bool everything = false;
};

/// Passes over the fields of one of everything, and tells how large each is, in order.
class FieldLayout {
public:
    uint64_t mixed = 0;
    template <class T>
    void plain(T&) {
        add(sizeof(T));
    }
    size_t count(size_t present) {
        add(1 << 20);
        return std::max<size_t>(present, 1);
    }
    void block(void*, size_t size) { add(size); }
    static constexpr bool everything = true;

private:
    void add(uint64_t size) { mixed = mixBits(mixed ^ size) + 0x9e3779b97f4a7c15ull; }
};

class FieldReader {
public:
    explicit FieldReader(const std::string& bytes) : bytes_(bytes) {}
    template <class T>
    void plain(T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        block(&value, sizeof value);
    }
    size_t count(size_t) {
        uint64_t n = 0;
        plain(n);
        if (n > bytes_.size() - at_) throw Error("a list is longer than the file");
        return size_t(n);
    }
    /// Any other byte in a bool is undefined behaviour.
    void plain(bool& value) {
        uint8_t byte = 0;
        plain(byte);
        if (byte > 1) throw Error("it holds {} where yes or no was expected", byte);
        value = byte == 1;
    }
    void block(void* data, size_t size) {
        if (size > bytes_.size() - at_) throw Error("it ends early");
        if (size) std::memcpy(data, bytes_.data() + at_, size);
        at_ += size;
    }
    bool atEnd() const { return at_ == bytes_.size(); }
    static constexpr bool everything = false;

private:
    const std::string& bytes_;
    size_t at_ = 0;
};

template <class File>
void fields(File& f, std::string& text) {
    text.resize(f.count(text.size()));
    f.block(text.data(), text.size());
}
/// Nothing of it is padding, whose bytes would be anybody's.
template <class T>
constexpr bool gapless =
    std::has_unique_object_representations_v<T> || std::is_floating_point_v<T> || std::is_same_v<T, Rgb>;
template <>
constexpr bool gapless<GlossyObservation> = sizeof(GlossyObservation) == 3 * sizeof(uint32_t) + 7 * sizeof(float);
template <>
constexpr bool gapless<PaletteColour> = sizeof(PaletteColour) == 4 * sizeof(float);

template <class File, class T>
void list(File& f, std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T> && gapless<T>);
    values.resize(f.count(values.size()));
    f.block(values.data(), values.size() * sizeof(T));
}
template <class File, class T, class Each>
void listOf(File& f, std::vector<T>& values, Each&& each) {
    values.resize(f.count(values.size()));
    for (T& value : values) each(value);
}

template <class File>
void fields(File& f, EmitterEvidence& e) {
    for (float* value : {&e.sceneContrast, &e.localContrast, &e.uniformity, &e.viewSpread, &e.edgeDrop,
                         &e.demandedAlbedo, &e.clippedFraction})
        f.plain(*value);
    f.plain(e.viewsAgree);
    f.plain(e.viewsSeen);
    f.plain(e.samples);
}

template <class File>
void fields(File& f, EmitterClusters& c) {
    listOf(f, c.emitters, [&](EmitterCluster& e) {
        fields(f, e.id);
        list(f, e.vertices);
        list(f, e.triangles);
        f.plain(e.radiance);
        f.plain(e.radianceSigma);
        f.plain(e.twoSided);
        f.plain(e.fitted);
        f.plain(e.unobserved);
        f.plain(e.positionSigma);
        f.plain(e.centroid);
        f.plain(e.normal);
        f.plain(e.area);
        fields(f, e.evidence);
        list(f, e.level);
        f.plain(e.lobe);
        list(f, e.inState);
    });
    listOf(f, c.rejected, [&](RejectedPatch& r) {
        f.plain(r.centroid);
        f.plain(r.radiance);
        fields(f, r.evidence);
        fields(f, r.reason);
    });
}

/// A measured lobe's table is not in the file: it is found again by its name.
template <class File>
void fields(File& f, Lobe& lobe, bool insideMixture) {
    uint8_t kind = uint8_t(lobe.kind);
    f.plain(kind);
    if (kind > uint8_t(Lobe::Kind::mixture) || (insideMixture && kind == uint8_t(Lobe::Kind::mixture)))
        throw Error("a lobe of an unknown kind");
    lobe.kind = Lobe::Kind(kind);
    f.plain(lobe.alpha);
    fields(f, lobe.name);
    listOf(f, lobe.parts, [&](Lobe& part) {
        if (insideMixture && !File::everything) throw Error("a mixture inside a mixture");
        if (!insideMixture) fields(f, part, true);
    });
    f.plain(lobe.fraction);
}

template <class File>
void fields(File& f, ComponentGloss& g) {
    f.plain(g.component);
    uint8_t has = g.lobe || File::everything ? 1 : 0;
    f.plain(has);
    if (has) {
        if (!g.lobe) g.lobe.emplace();
        fields(f, *g.lobe, false);
    }
    f.plain(g.weight);
    f.plain(g.matte);
    f.plain(g.residual);
    f.plain(g.residualMatte);
    list(f, g.observations);
}

template <class File>
void fields(File& f, PlanChoices& p) {
    for (bool* choice :
         {&p.distantLight, &p.bounce, &p.lateBounce, &p.bounceLikely, &p.unobservedVertices, &p.emptyColumns,
          &p.matteComponents, &p.lostLobes, &p.agreeingRays, &p.flatLevels, &p.lastDigits, &p.mattePointsInDetail})
        f.plain(*choice);
    static_assert(sizeof(PlanChoices) == 12, "every choice has to come back");
}

template <class File>
void fields(File& f, SolvePlan& p) {
    fields(f, p.choices);
    listOf(f, p.stages, [&](PlannedStage& s) {
        std::string name = fileNameOf(s.stage);
        fields(f, name);
        s.stage = stageNamed(name);
        for (double* value : {&s.predictedSeconds, &s.measuredSeconds, &s.predictedMib, &s.measuredMib})
            f.plain(*value);
    });
    listOf(f, p.leftOut, [&](PlannedOmission& o) {
        std::string what = nameOf(o.what);
        fields(f, what);
        o.what = omissionNamed(what);
        fields(f, o.reason);
        f.plain(o.savedSeconds);
        f.plain(o.savedMib);
    });
    f.plain(p.planningSeconds);
    uint8_t suspects = p.suspectedLight || File::everything ? 1 : 0;
    f.plain(suspects);
    if (!suspects) return;
    if (!p.suspectedLight) p.suspectedLight.emplace();
    SuspectedLight& light = *p.suspectedLight;
    for (double* value :
         {&light.position.x, &light.position.y, &light.position.z, &light.gain, &light.certainty, &light.fraction})
        f.plain(*value);
}

template <class File>
void fields(File& f, SolveCheckpoint& c) {
    f.plain(c.step);
    f.plain(c.between);
    f.plain(c.seconds);
    fields(f, c.clusters);
    list(f, c.suspect);
    listOf(f, c.leaves, [&](Leaf& leaf) {
        f.plain(leaf.level);
        f.plain(leaf.x);
        f.plain(leaf.y);
        f.plain(leaf.environment);
    });
    list(f, c.leafRadiance);
    list(f, c.emitterRadiance);
    f.plain(c.environmentBlack);
    f.plain(c.noMetals);
    f.plain(c.backgroundRefuted);
    f.plain(c.refined);
    f.plain(c.bounceKept);
    f.plain(c.visibilityStep);
    f.plain(c.refinedMisfit);
    f.plain(c.bouncedFraction);
    fields(f, c.noBounceBecause);
    for (std::vector<Rgb>* values : {&c.vertexBounce, &c.outgoing, &c.matteRadiance, &c.matteSigma}) list(f, *values);
    for (PriorStrength* strength : {&c.lightSmoothness, &c.albedoSmoothness}) {
        f.plain(strength->factor);
        fields(f, strength->chosenBy);
        listOf(f, strength->trials, [&](PriorStrength::Trial& trial) {
            f.plain(trial.factor);
            f.plain(trial.misfit);
            f.plain(trial.error);
        });
    }
    listOf(f, c.gloss, [&](ComponentGloss& g) { fields(f, g); });
    listOf(f, c.firstGloss, [&](ComponentGloss& g) { fields(f, g); });
    f.plain(c.metalsHeard);
    f.plain(c.metalsJoined);
    f.plain(c.glossSettled);
    f.plain(c.lightUnfinished);
    list(f, c.information);
    for (std::vector<double>& observations : c.informationOfObservations) list(f, observations);
    for (std::vector<double>& seen : c.informationSeen) list(f, seen);
    list(f, c.albedo);
    list(f, c.confidence);
    list(f, c.palette);
    listOf(f, c.timeline, [&](TimelineEntry& t) {
        f.plain(t.seconds);
        fields(f, t.stage);
        f.plain(t.iteration);
        f.plain(t.objective);
        f.plain(t.rmse);
    });
    f.plain(c.kktResidual);
    fields(f, c.plan);
    list(f, c.patchUsed);
}

}  // namespace

std::string checkpointBytes(const SolveCheckpoint& checkpoint) {
    FieldWriter writer;
    SolveCheckpoint copy = checkpoint;
    fields(writer, copy);
    return std::move(writer.bytes);
}

uint32_t checkpointLayout() {
    FieldLayout layout;
    SolveCheckpoint one;
    fields(layout, one);
    return uint32_t(layout.mixed >> 32) | 1;
}

SolveCheckpoint checkpointFromBytes(const std::string& bytes) {
    FieldReader reader(bytes);
    SolveCheckpoint checkpoint;
    fields(reader, checkpoint);
    if (!reader.atEnd()) throw Error("it goes on after its end");
    if (checkpoint.leaves.size() != checkpoint.leafRadiance.size() ||
        checkpoint.clusters.emitters.size() != checkpoint.emitterRadiance.size() ||
        checkpoint.suspect.size() != checkpoint.clusters.emitters.size())
        throw Error("its lists do not fit each other");
    const size_t n = checkpoint.informationSeen[0].size();
    bool fit = checkpoint.information.size() == 3 * n * (3 * n + 1) / 2;
    for (size_t k = 0; k < 3; ++k)
        fit &= checkpoint.informationSeen[k].size() == n && (checkpoint.informationOfObservations[k].empty() ||
                                                             checkpoint.informationOfObservations[k].size() == n * n);
    if (!fit) throw Error("its lists do not fit each other");
    return checkpoint;
}

}  // namespace relamp
