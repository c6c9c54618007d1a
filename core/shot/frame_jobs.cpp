#include "shot/frame_jobs.h"

#include "base/log.h"
#include "capture/load_capture.h"
#include "shot/camera_path.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace {

int wholeNumber(const std::string& text, const std::string& where) {
    if (text.empty() || text.size() > 8 || text.find_first_not_of("0123456789") != std::string::npos)
        throw BadOption("{}: '{}' is not a number", where, text);
    return std::stoi(text);
}

constexpr size_t maxFrames = 1'000'000;

/// One camera for every frame of a range: what changes is the look. Without a range one frame.
std::vector<FrameJob> stillJobs(const FrameJob& still, const std::string& frames) {
    if (frames.empty()) return {still};
    const std::vector<int> wanted = parseFrameRange(frames);
    std::vector<FrameJob> jobs(wanted.size(), still);
    for (size_t i = 0; i < jobs.size(); ++i) {
        const std::string name = numbered(still.file, wanted[i]);
        if (name.empty() && jobs.size() > 1)
            throw BadOption("{}: several frames need a name with #### or %04d", still.file.string());
        if (!name.empty()) jobs[i].file = name;
        jobs[i].number = wanted[i];
        jobs[i].still = true;
    }
    return jobs;
}

/// FrameJob of every wanted number out of cameras numbered from 1.
std::vector<FrameJob> numberedJobs(std::vector<FrameJob> all, const std::string& frames,
                                   const std::filesystem::path& output) {
    std::vector<int> wanted;
    if (frames.empty())
        for (size_t i = 1; i <= all.size(); ++i) wanted.push_back(int(i));
    else wanted = parseFrameRange(frames);
    std::vector<FrameJob> jobs;
    for (int n : wanted) {
        if (n < 1 || size_t(n) > all.size()) {
            logWarning("frame {}: outside the sequence's 1 to {}, skipped", n, all.size());
            continue;
        }
        std::string name = numbered(output, n);
        if (name.empty()) {
            if (wanted.size() > 1) throw BadOption("{}: several frames need a name with #### or %04d", output.string());
            name = output.string();
        }
        FrameJob job = all[size_t(n - 1)];
        job.file = name;
        job.number = n;
        jobs.push_back(std::move(job));
    }
    if (jobs.empty()) throw BadOption("--frames {}: holds none of the frames 1 to {}", frames, all.size());
    return jobs;
}

}  // namespace

std::vector<int> parseFrameRange(const std::string& text, const std::string& option) {
    std::vector<int> numbers;
    size_t at = 0;
    while (at <= text.size()) {
        const size_t comma = std::min(text.find(',', at), text.size());
        std::string part = text.substr(at, comma - at);
        int step = 1;
        if (const size_t colon = part.find(':'); colon != std::string::npos) {
            step = wholeNumber(part.substr(colon + 1), option);
            part.resize(colon);
            if (step < 1) throw BadOption("{}: a step of 0 never ends", option);
        }
        const size_t dash = part.find('-');
        const int first = wholeNumber(part.substr(0, dash), option);
        const int last = dash == std::string::npos ? first : wholeNumber(part.substr(dash + 1), option);
        if (last < first) throw BadOption("{}: {} runs backwards", option, part);
        if (size_t(last - first) / size_t(step) + numbers.size() >= maxFrames)
            throw BadOption("{}: {} asks for more than {} numbers", option, text, maxFrames);
        for (int n = first; n <= last; n += step) numbers.push_back(n);
        at = comma + 1;
    }
    return numbers;
}

std::vector<FrameJob> frameJobs(const Capture& capture, const std::string& camera, const std::string& frames,
                                const std::string& size, const std::filesystem::path& output) {
    std::vector<FrameJob> jobs;
    const bool sequence = camera == "all" || isCameraPath(camera);
    if (camera == "all") {
        for (size_t i = 0; i < capture.views.size(); ++i)
            jobs.push_back({capture.views[i].camera, {}, int(i) + 1, int(i)});
        jobs = numberedJobs(std::move(jobs), frames, output);
    } else if (sequence) {
        for (const Camera& place : cameraPath(capture, camera)) jobs.push_back({place, {}, 1, -1});
        jobs = numberedJobs(std::move(jobs), frames, output);
    } else if (camera.find_first_not_of("0123456789") == std::string::npos && !camera.empty()) {
        const int n = wholeNumber(camera, "--camera");
        if (size_t(n) >= capture.views.size())
            throw BadOption(
                "--camera {}: does not exist, expected 0 to {}, a camera file, turntable:N, path:V,V,...:N, or all", n,
                capture.views.size() - 1);
        jobs = stillJobs({capture.views[size_t(n)].camera, output, n + 1, n}, frames);
    } else {
        const CameraFile file = readCameraPath(capture, camera);
        for (const Camera& place : file.cameras) jobs.push_back({place, output, 1, -1});
        if (!file.sequence) jobs = stillJobs(jobs.front(), frames);
        else jobs = numberedJobs(std::move(jobs), frames, output);
    }
    if (!size.empty()) {
        const size_t x = size.find('x');
        if (x == std::string::npos) throw BadOption("--size {}: expected WxH", size);
        const int w = wholeNumber(size.substr(0, x), "--size"), h = wholeNumber(size.substr(x + 1), "--size");
        // A strip of rows is held in memory, so a side has a limit too.
        constexpr int mostSide = 1 << 17;
        if (w < 1 || h < 1 || std::max(w, h) > mostSide || int64_t(w) * h > (int64_t(1) << 28))
            throw BadOption("--size {}: expected 1 to 2^28 pixels, {} at most on a side", size, mostSide);
        for (FrameJob& job : jobs) {
            if (w != job.camera.width || h != job.camera.height) job.resized = true;
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

Camera cropped(Camera camera, const ImageBox& box) {
    camera.centreX -= box.left;
    camera.centreY -= box.top;
    camera.width = box.width;
    camera.height = box.height;
    return camera;
}

}  // namespace relamp
