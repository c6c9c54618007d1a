#include "shot/checkpoint.h"

#include <bit>
#include <cstring>

#include "base/atomic_file.h"
#include "base/log.h"
#include "base/random.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr char magic[8] = {'r', 'e', 'l', 'a', 'm', 'p', 'C', 'P'};
constexpr uint32_t formatVersion = 16;

struct CheckpointHeader {
    char magic[8];
    uint32_t version = 0, layout = 0;
    uint64_t fingerprint = 0, size = 0, hash = 0;
};

/// Mixes bytes, eight at a time.
class Fingerprint {
public:
    void bytes(const void* data, size_t size) {
        const char* at = static_cast<const char*>(data);
        add(size);
        for (; size >= 8; at += 8, size -= 8) {
            uint64_t word = 0;
            std::memcpy(&word, at, 8);
            add(word);
        }
        uint64_t rest = 0;
        if (size) std::memcpy(&rest, at, size);
        add(rest);
    }
    template <class T>
    void all(const std::vector<T>& values) {
        static_assert(std::has_unique_object_representations_v<T> || std::is_same_v<T, Rgb> ||
                      std::is_same_v<T, float>);
        bytes(values.data(), values.size() * sizeof(T));
    }
    void add(uint64_t word) { state_ = mixBits(state_ ^ word) + 0x9e3779b97f4a7c15ull; }
    void number(double value) { add(std::bit_cast<uint64_t>(value)); }
    void text(const std::string& value) { bytes(value.data(), value.size()); }
    uint64_t value() const { return state_; }

private:
    uint64_t state_ = 0x243f6a8885a308d3ull;
};

uint64_t hashOf(const std::string& bytes) {
    Fingerprint f;
    f.text(bytes);
    return f.value();
}

}  // namespace

fs::path checkpointFile(const fs::path& shot) {
    const fs::path target = folderPlace(shot);
    return target.parent_path() / fmt::format(".{}.checkpoint", target.filename().string());
}

uint64_t solveFingerprint(const Capture& capture, const SolveOptions& o, bool everything) {
    Fingerprint f;
    f.text(RELAMP_VERSION);
    for (const View& view : capture.views) {
        const Camera& c = view.camera;
        f.text(view.name);
        f.add(uint64_t(c.width) << 32 | uint32_t(c.height));
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row) f.number(c.worldFromCamera[column][row]);
        // The lens, as what it does to a few directions.
        for (const Vec2 at : {Vec2(0.1f, 0.2f), Vec2(0.5f, 0.5f), Vec2(0.9f, 0.3f), Vec2(0.3f, 0.95f)}) {
            const Vec3 d = c.rayDirection(at * Vec2(c.width, c.height));
            for (int k = 0; k < 3; ++k) f.number(d[k]);
        }
        f.number(view.saturation);
        if (capture.states.size() > 1) f.add(view.state);
        f.all(view.image.pixels);
        f.all(view.image.usable);
    }
    for (const int environment : capture.environmentOfState) f.add(uint64_t(environment + 1));
    f.all(capture.mesh.positions);
    f.all(capture.mesh.normals);
    f.all(capture.mesh.triangles);
    for (const double value : {double(o.nearField),        double(o.startLevel),       double(o.refineRounds),
                               double(o.maxLeaves),        double(o.visibilitySide),   double(o.startIterations),
                               double(o.refineIterations), double(o.glossRounds),      double(o.turns),
                               double(o.splitFraction),    double(o.prior.step),       double(o.prior.edge),
                               double(o.prior.iterations), double(o.gauge.kind),       double(o.gauge.view),
                               double(o.gauge.pixel.x),    double(o.gauge.pixel.y),    double(o.gauge.whiteAlbedo),
                               double(o.gauge.radiance.x), double(o.gauge.radiance.y), double(o.gauge.radiance.z),
                               double(o.gauge.albedo),     double(o.bounce),           double(everything),
                               double(o.lightSmoothness),  double(o.albedoSmoothness), double(o.askForStrength),
                               double(o.palette),          double(o.mostLobes),        double(o.metalRounds)})
        f.number(value);
    for (const Lobe& lobe : o.basis.lobes) {
        f.text(lobe.name);
        if (lobe.measured) f.all(lobe.measured->cells);
    }
    f.text(o.gauge.emitter);
    for (const KnownPatch& patch : o.patches)
        for (const double value :
             {double(patch.view), double(patch.centre.x), double(patch.centre.y), double(patch.radius),
              double(patch.albedo.x), double(patch.albedo.y), double(patch.albedo.z), double(patch.noise)})
            f.number(value);
    f.add(o.seed);
    return f.value();
}

void writeCheckpoint(const fs::path& file, uint64_t fingerprint, const SolveCheckpoint& checkpoint) {
    const std::string payload = checkpointBytes(checkpoint);
    CheckpointHeader header;
    std::memcpy(header.magic, magic, sizeof magic);
    header.version = formatVersion;
    header.layout = checkpointLayout();
    header.fingerprint = fingerprint;
    header.size = payload.size();
    header.hash = hashOf(payload);
    std::string bytes(sizeof header, '\0');
    std::memcpy(bytes.data(), &header, sizeof header);
    writeBytesAtomically(file, bytes + payload);
}

FoundCheckpoint readCheckpoint(const fs::path& file, uint64_t fingerprint) {
    FoundCheckpoint found;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) {
        found.refused = fmt::format("{}: there is no checkpoint", file.string());
        return found;
    }
    const auto refuse = [&](const char* why) {
        found.refused = fmt::format("{}: {}", file.string(), why);
        return found;
    };
    try {
        const std::string bytes = readBytes(file);
        CheckpointHeader header;
        if (bytes.size() < sizeof header) return refuse("is no checkpoint, or a damaged one");
        std::memcpy(&header, bytes.data(), sizeof header);
        if (std::memcmp(header.magic, magic, sizeof magic) != 0) return refuse("is no checkpoint, or a damaged one");
        if (header.version != formatVersion || header.layout != checkpointLayout())
            return refuse("was written by another version of relamp");
        const std::string payload = bytes.substr(sizeof header);
        if (payload.size() != header.size || hashOf(payload) != header.hash) return refuse("is damaged");
        if (header.fingerprint != fingerprint)
            return refuse("belongs to another capture, to other options or to another version of relamp");
        found.checkpoint = checkpointFromBytes(payload);
    } catch (const Error& error) {
        found.checkpoint.reset();
        found.refused = fmt::format("{}: is damaged ({})", file.string(), error.what());
    }
    return found;
}

void CheckpointKeeper::take(const SolveCheckpoint& checkpoint) {
    if (failed_) return;
    if (checkpoint.seconds - last_ < everySeconds_) waiting_ = checkpoint;
    else write(checkpoint);
}

void CheckpointKeeper::flush() {
    if (waiting_ && !failed_) write(SolveCheckpoint(std::move(*waiting_)));
}

void CheckpointKeeper::write(const SolveCheckpoint& checkpoint) {
    waiting_.reset();
    try {
        writeCheckpoint(file_, fingerprint_, checkpoint);
        last_ = checkpoint.seconds;
    } catch (const Error& error) {
        failed_ = true;
        logWarning("no checkpoint can be written, a killed solve would have to start again: {}", error.what());
    }
}

void CheckpointKeeper::remove() {
    waiting_.reset();
    std::error_code ignored;
    fs::remove(file_, ignored);
}

}  // namespace relamp
