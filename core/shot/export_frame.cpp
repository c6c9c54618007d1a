#include "shot/export_frame.h"

#include <cctype>
#include <set>

#include "base/error.h"
#include "base/log.h"
#include "capture/load_capture.h"
#include "image/image_io.h"

namespace relamp {
namespace {

/// FRAME.####.exr or FRAME.%04d.exr with a number put in; empty when the file name has no place for one.
std::string numbered(const std::filesystem::path& path, int number) {
    constexpr size_t widest = 32;
    const std::string name = path.filename().string();
    const auto put = [&](size_t begin, size_t end, size_t width) {
        if (width > widest) throw BadOption("{}: a frame number of {} digits is too wide", path.string(), width);
        return (path.parent_path() / (name.substr(0, begin) + fmt::format("{:0{}}", number, width) + name.substr(end))).string();
    };
    if (const size_t hash = name.find('#'); hash != std::string::npos) {
        const size_t end = std::min(name.find_first_not_of('#', hash), name.size());
        return put(hash, end, end - hash);
    }
    if (const size_t percent = name.find('%'); percent != std::string::npos) {
        const size_t end = std::min(name.find_first_not_of("0123456789", percent + 1), name.size());
        if (end < name.size() && name[end] == 'd') {
            const std::string width = name.substr(percent + 1, end - percent - 1);
            return put(percent, end + 1, width.empty() ? 1 : width.size() > 4 ? widest + 1 : size_t(std::stoi(width)));
        }
    }
    return "";
}

int wholeNumber(const std::string& text, const std::string& where) {
    if (text.empty() || text.size() > 8 || text.find_first_not_of("0123456789") != std::string::npos) throw BadOption("{}: '{}' is not a number", where, text);
    return std::stoi(text);
}

constexpr size_t maxFrames = 1'000'000;

/// Nuke drops leading digits, other readers split at the first dot: letters, digits and underscores only.
std::string channelSafe(const std::string& name) {
    std::string safe;
    for (char c : name) safe += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    if (safe.empty() || !std::isalpha(static_cast<unsigned char>(safe[0]))) safe = "L_" + safe;
    return safe;
}

std::set<std::string> layersOf(const std::string& layers) {
    static const std::set<std::string> known{"groups", "albedo", "normal", "position", "depth"};
    if (layers == "all") return known;
    std::set<std::string> wanted;
    for (size_t at = 0; at < layers.size();) {
        const size_t comma = std::min(layers.find(',', at), layers.size());
        const std::string name = layers.substr(at, comma - at);
        if (!known.count(name)) throw BadOption("--layers {}: unknown, expected groups, albedo, normal, position, depth or all", name);
        wanted.insert(name);
        at = comma + 1;
    }
    return wanted;
}

}  // namespace

void checkLayers(const std::string& layers) { layersOf(layers); }

std::vector<int> parseFrameRange(const std::string& text) {
    std::vector<int> numbers;
    size_t at = 0;
    while (at <= text.size()) {
        const size_t comma = std::min(text.find(',', at), text.size());
        std::string part = text.substr(at, comma - at);
        int step = 1;
        if (const size_t colon = part.find(':'); colon != std::string::npos) {
            step = wholeNumber(part.substr(colon + 1), "--frames");
            part.resize(colon);
            if (step < 1) throw BadOption("--frames: a step of 0 never ends");
        }
        const size_t dash = part.find('-');
        const int first = wholeNumber(part.substr(0, dash), "--frames");
        const int last = dash == std::string::npos ? first : wholeNumber(part.substr(dash + 1), "--frames");
        if (last < first) throw BadOption("--frames: {} runs backwards", part);
        if (size_t(last - first) / size_t(step) + numbers.size() >= maxFrames) throw BadOption("--frames: {} asks for more than {} frames", text, maxFrames);
        for (int n = first; n <= last; n += step) numbers.push_back(n);
        at = comma + 1;
    }
    return numbers;
}

std::vector<FrameJob> frameJobs(const Capture& capture, const std::string& camera, const std::string& frames, const std::string& size,
                                const std::filesystem::path& output) {
    std::vector<FrameJob> jobs;
    if (!frames.empty() && camera != "all") throw BadOption("--frames {}: needs --camera all", frames);
    if (camera == "all") {
        std::vector<int> wanted;
        if (frames.empty())
            for (size_t i = 1; i <= capture.views.size(); ++i) wanted.push_back(int(i));
        else wanted = parseFrameRange(frames);
        for (int n : wanted) {
            if (n < 1 || size_t(n) > capture.views.size()) {
                logWarning("frame {}: outside the shot's 1 to {}, skipped", n, capture.views.size());
                continue;
            }
            std::string name = numbered(output, n);
            if (name.empty()) {
                if (wanted.size() > 1) throw BadOption("{}: several frames need a name with #### or %04d", output.string());
                name = output.string();
            }
            jobs.push_back({capture.views[size_t(n - 1)].camera, name, n});
        }
    } else if (camera.find_first_not_of("0123456789") == std::string::npos && !camera.empty()) {
        const int n = wholeNumber(camera, "--camera");
        if (size_t(n) >= capture.views.size()) throw BadOption("--camera {}: does not exist, expected 0 to {}, a camera file, or all", n, capture.views.size() - 1);
        jobs.push_back({capture.views[size_t(n)].camera, output, n + 1});
    } else {
        // A camera file has the axes and the unit of the capture's files.
        FrameJob job{readCameraFile(camera), output, 1};
        job.camera.worldFromCamera = DMat4(glm::dmat3(capture.worldFromFile)) * job.camera.worldFromCamera;
        job.camera.worldFromCamera[3] = glm::dvec4(job.camera.position() * capture.metresPerUnit, 1);
        jobs.push_back(std::move(job));
    }
    if (!size.empty()) {
        const size_t x = size.find('x');
        if (x == std::string::npos) throw BadOption("--size {}: expected WxH", size);
        const int w = wholeNumber(size.substr(0, x), "--size"), h = wholeNumber(size.substr(x + 1), "--size");
        if (w < 1 || h < 1 || int64_t(w) * h > (int64_t(1) << 28)) throw BadOption("--size {}: expected 1 to 2^28 pixels", size);
        for (FrameJob& job : jobs) {
            const double sx = double(w) / job.camera.width, sy = double(h) / job.camera.height;
            job.camera.focalX *= sx;
            job.camera.centreX *= sx;
            job.camera.focalY *= sy;
            job.camera.centreY *= sy;
            job.camera.width = w;
            job.camera.height = h;
        }
    }
    return jobs;
}

double writeFrame(const std::filesystem::path& file, const Frame& frame, const RelitScene& relit, const Camera& camera, const std::string& layers) {
    const size_t pixels = frame.beauty.size();
    // The groups must add up to the beauty, whatever is written.
    double worst = 0, brightest = 1e-12;
    for (const Rgb& b : frame.beauty) brightest = std::max(brightest, double(maxChannel(b)));
    for (size_t p = 0; p < pixels; ++p) {
        Rgb sum = frame.world[p];
        for (const auto& group : frame.byEmitter) sum += group[p];
        worst = std::max(worst, double(maxChannel(glm::abs(sum - frame.beauty[p]))) / brightest);
    }
    std::string extension = file.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (extension != ".exr") {
        Image image(frame.width, frame.height);
        image.pixels = frame.beauty;
        writeImage(file, image);
        return worst;
    }
    const std::set<std::string> wanted = layersOf(layers);
    std::vector<Channel> channels;
    const auto add = [&](const std::string& prefix, const char* axes, const std::vector<Vec3>& values, bool half) {
        for (int c = 0; c < 3; ++c) {
            Channel channel{prefix.empty() ? std::string(1, axes[c]) : prefix + "." + axes[c], half, {}};
            channel.values.reserve(pixels);
            for (const Vec3& v : values) channel.values.push_back(half ? std::min(v[c], 65504.0f) : v[c]);
            channels.push_back(std::move(channel));
        }
    };
    add("", "RGB", frame.beauty, true);
    channels.push_back({"A", true, frame.alpha});
    if (wanted.count("groups")) {
        add("Combined_world", "RGB", frame.world, true);
        for (size_t e = 0; e < frame.byEmitter.size(); ++e) add("Combined_" + channelSafe(relit.emitters[e].id), "RGB", frame.byEmitter[e], true);
    }
    if (wanted.count("albedo")) add("albedo", "RGB", frame.albedo, true);
    if (wanted.count("normal")) add("normal", "XYZ", frame.normal, false);
    if (wanted.count("position")) add("position", "XYZ", frame.position, false);
    if (wanted.count("depth")) channels.push_back({"depth.Z", false, frame.depth});
    std::string matrix;
    const DMat4 cameraFromWorld = glm::inverse(camera.worldFromCamera);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) matrix += fmt::format("{}{}", matrix.empty() ? "" : " ", cameraFromWorld[c][r]);
    writeChannels(file, frame.width, frame.height, channels, {{"relamp:worldToCamera", matrix}, {"Software", "relamp " RELAMP_VERSION}});
    return worst;
}

}  // namespace relamp
