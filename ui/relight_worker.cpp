#include "relight_worker.h"

#include <chrono>
#include <utility>

#include "shot/frame_jobs.h"

namespace relamp::ui {
bool sameEye(const RelightRequest& a, const RelightRequest& b) {
    return a.eye.worldFromCamera == b.eye.worldFromCamera && a.eye.width == b.eye.width &&
           a.eye.height == b.eye.height && a.eye.focalX == b.eye.focalX && a.eye.focalY == b.eye.focalY &&
           a.eye.centreX == b.eye.centreX && a.eye.centreY == b.eye.centreY && a.orthographic == b.orthographic;
}

bool sameImage(const RelightRequest& a, const RelightRequest& b) {
    return a.scene == b.scene && a.estimate == b.estimate && a.look == b.look && sameEye(a, b);
}

namespace {

/// A hand in a drag that has not moved for this long lies still: then the image is refined.
constexpr std::chrono::milliseconds handAtRest(250);

/// Which slices of the refinement at rest are shown: drawing them all takes as long as the slices where OpenGL is
/// software.
class SlicePace {
public:
    bool due(bool always) {
        constexpr std::chrono::milliseconds between(250);
        const auto now = std::chrono::steady_clock::now();
        if (!always && now - shown_ < between) return false;
        shown_ = now;
        return true;
    }

private:
    std::chrono::steady_clock::time_point shown_;
};

/// Seconds that the first image at rest may take; with what comes before it, less than five from the release.
constexpr double firstImagePatience = 4;
/// From a vertex, for the image at rest: a quarter of what a file takes. Neighbours share them.
constexpr uint32_t restBounceRays = 64;

/// From the axis to the farthest corner of the image, with a little to spare for a turn of the head; radians.
float halfAngleOf(const Camera& camera) {
    if (!(camera.focalX > 0) || !(camera.focalY > 0)) return 0;
    const double x = std::max(camera.centreX, camera.width - camera.centreX) / camera.focalX,
                 y = std::max(camera.centreY, camera.height - camera.centreY) / camera.focalY;
    return float(std::min(1.05 * std::atan(std::hypot(x, y)), 1.5));
}

}  // namespace

RelightWorker::RelightWorker(std::function<void()> wake, std::function<LiveDevices()> makeDevices, bool forceDevice)
    : wake_(std::move(wake)),
      makeDevices_(std::move(makeDevices)),
      forceDevice_(forceDevice),
      thread_([this](std::stop_token stop) { run(stop); }) {}

RelightWorker::~RelightWorker() {
    thread_.request_stop();
    {
        std::lock_guard lock(mutex_);
        if (running_) running_->requestStop();
    }
    changed_.notify_all();
}

void RelightWorker::request(RelightRequest request) {
    {
        std::lock_guard lock(mutex_);
        const bool same = sameImage(request, request_), sameRest = same && request.region == request_.region;
        if (sameRest && request.restImage == request_.restImage && request.dragging == request_.dragging &&
            request.pickSerial == request_.pickSerial && request.time == request_.time)
            return;
        const bool sameScene = request.scene == request_.scene && request.estimate == request_.estimate;
        // An image at rest ends at once. A slice is finished first, or a steady drag would never show anything; so is
        // a bake, unless another scene is wanted.
        if (running_ && (runningIsRest_ || !sameScene)) running_->requestStop();
        if (!sameRest) rest_.reset();
        if (!same) {
            owed_ = request.scene && request.estimate;
            changedAt_ = std::chrono::steady_clock::now();
        }
        if (request.scene != request_.scene) frame_.reset();
        request_ = std::move(request);
        ++serial_;
        working_ = true;
        refining_ = refining_ || !same;
    }
    changed_.notify_all();
}

void RelightWorker::clear() { request({}); }

RelitImage RelightWorker::frame() const {
    std::lock_guard lock(mutex_);
    if (!std::exchange(taken_, true)) changed_.notify_all();
    return {frame_, frameTime_};
}
std::shared_ptr<const Frame> RelightWorker::restFrame() const {
    std::lock_guard lock(mutex_);
    return rest_;
}
std::optional<PointLight> RelightWorker::takePointLight(uint64_t serial) {
    std::lock_guard lock(mutex_);
    if (answered_ != serial) return std::nullopt;
    return std::exchange(pointLight_, std::nullopt);
}
std::string RelightWorker::takeError() {
    std::lock_guard lock(mutex_);
    return std::exchange(error_, {});
}
bool RelightWorker::working() const {
    std::lock_guard lock(mutex_);
    return working_;
}
bool RelightWorker::imageOwed() const {
    std::lock_guard lock(mutex_);
    return owed_;
}
bool RelightWorker::refining() const {
    std::lock_guard lock(mutex_);
    return refining_;
}

void RelightWorker::renderAtRest(const RelightRequest& request, uint64_t serial, const std::stop_token& stop) {
    const auto progress = std::make_shared<Progress>();
    {
        std::lock_guard lock(mutex_);
        if (serial_ != serial || stop.stop_requested()) return;
        running_ = progress;
        runningIsRest_ = true;
    }
    const bool file = request.look.environment.source == EnvironmentLook::Source::file;
    if (!file || !(restEnvironment_ == request.look.environment)) restDistant_.reset();
    restEnvironment_ = request.look.environment;
    if (file && !restDistant_) restDistant_ = distantOfLook(*request.estimate, restEnvironment_);
    const RelitScene relit =
        applyLook(*request.scene, *request.estimate, request.look, *progress, restDistant_, restBounceRays);
    const Camera eye = request.region
                           ? cropped(request.eye, boxOf(*request.region, request.eye.width, request.eye.height))
                           : request.eye;
    FrameOptions options;
    options.background = false;
    // Three, or two where three took too long the last time: that is the difference between 40 and 39 dB.
    const double pixels = double(eye.width) * eye.height;
    options.samplesPerPixel = 3 * pixels * restSecondsPerSample_ <= firstImagePatience ? 3 : 2;
    options.denoise = true;
    options.groups = false;
    // Whole passes that add up. A slow machine ends with the first of them. Each is denoised with all its samples: one
    // of three is as clean as two of two, in two thirds of the time.
    // A region is done sooner, and gets more of them.
    const int passes = request.region ? 12 : 3;
    constexpr double patience = 4.2;  // seconds; with the wait before it, five from the release to the last image
    Frame sum;
    for (int pass = 0; pass < passes; ++pass) {
        if (pass > 0 && progress->seconds() * (pass + 1) / pass > patience) break;
        options.seed = uint64_t(pass + 2);
        Frame frame = renderFrame(relit, eye, options, *progress);
        if (pass == 0) {
            restSecondsPerSample_ = progress->seconds() / (options.samplesPerPixel * pixels);
            sum = std::move(frame);
        } else {
            for (size_t i = 0; i < sum.beauty.size(); ++i) {
                sum.beauty[i] += frame.beauty[i];
                sum.alpha[i] += frame.alpha[i];
            }
        }
        const auto shown = std::make_shared<Frame>();
        shown->width = sum.width;
        shown->height = sum.height;
        shown->beauty.resize(sum.beauty.size());
        shown->alpha.resize(sum.alpha.size());
        const float fraction = 1.0f / float(pass + 1);
        for (size_t i = 0; i < sum.beauty.size(); ++i) {
            shown->beauty[i] = sum.beauty[i] * fraction;
            shown->alpha[i] = sum.alpha[i] * fraction;
        }
        {
            std::lock_guard lock(mutex_);
            if (serial_ != serial) return;
            rest_ = shown;
        }
        if (wake_) wake_();
    }
}

void RelightWorker::publish(const LiveScene& live, const RelightRequest& request, uint64_t serial, bool refined) {
    std::shared_ptr<const LiveFrame> frame = live.frame();
    {
        std::lock_guard lock(mutex_);
        if (request_.scene == request.scene) frame_ = std::move(frame), frameTime_ = request.time, taken_ = false;
        if (sameImage(request_, request)) owed_ = false;
        refining_ = !refined || serial_ != serial;
    }
    if (wake_) wake_();
}

bool RelightWorker::waitUntilTaken(uint64_t serial, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, stop, std::chrono::milliseconds(200), [&] { return taken_ || serial_ != serial; });
    changed_.wait_until(lock, stop, changedAt_ + handAtRest, [&] { return serial_ != serial; });
    return serial_ != serial || stop.stop_requested();
}

void RelightWorker::run(std::stop_token stop) {
    LiveOptions options;
    options.forceDevice = forceDevice_;
    std::unique_ptr<LiveScene> live;
    RelightRequest held;  // what `live` shows
    uint64_t done = 0;    // serial of the request that was finished
    bool refined = false;
    SlicePace pace;
    while (!stop.stop_requested()) {
        RelightRequest request;
        uint64_t serial;
        const auto progress = std::make_shared<Progress>();
        {
            std::unique_lock lock(mutex_);
            if (serial_ == done) {
                working_ = refining_ = false;
                changed_.wait(lock, stop, [&] { return serial_ != done; });
            }
            // Under the lock, so that a step that starts is always one that the destructor can end.
            if (stop.stop_requested()) return;
            request = request_;
            serial = serial_;
            running_ = progress;
            runningIsRest_ = false;
        }
        try {
            if (!request.scene || !request.estimate) {
                live.reset();
                held = {};
                std::lock_guard lock(mutex_);
                if (serial_ == serial) {
                    frame_.reset();
                    rest_.reset();
                }
                done = serial;
                continue;
            }
            if (!live || request.scene != held.scene || request.estimate != held.estimate) {
                live.reset();
                if (makeDevices_) options.devices = std::exchange(makeDevices_, {})();
                options.cacheFolder = request.cacheFolder;
                live = std::make_unique<LiveScene>(request.scene, request.estimate, options, *progress);
                held = {};
                held.scene = request.scene;
                held.estimate = request.estimate;
                live->setLook(Look{});
                refined = false;
                std::lock_guard lock(mutex_);
                if (serial_ != serial) continue;  // the bake stays, the look may be newer
            }
            const bool changed = !(request.look == held.look) || !sameEye(request, held);
            if (!(request.look == held.look)) {
                live->setLook(request.look);
                held.look = request.look;
                refined = false;
            }
            if (!sameEye(request, held) || !refined) {
                const Vec3 forward(request.eye.forward());
                live->setEye({Vec3(request.eye.position()), forward, request.orthographic, halfAngleOf(request.eye)});
                if (!sameEye(request, held)) refined = false;
                held.eye = request.eye;
                held.orthographic = request.orthographic;
            }
            if (!refined) {
                if (!changed && request.dragging && waitUntilTaken(serial, stop)) continue;
                // The first image is shown before it is refined: what moves follows the hand. In a drag the next step
                // waits for the slice that runs: they are short then.
                refined = live->refine(changed ? 0 : request.dragging ? 0.012 : 0.04, *progress);
                if (pace.due(refined || changed || request.dragging)) publish(*live, request, serial, refined);
                if (!refined) continue;
            } else if (request.time != held.time) {
                publish(*live, request, serial, true);  // the same image answers for another time
            }
            held.time = request.time;
            bool asked;
            {
                std::lock_guard lock(mutex_);
                asked = request.pickSerial != answered_;
            }
            if (request.pickSerial && asked) {
                PointLight light = live->lightAt(request.pickTriangle, request.pickBarycentric);
                {
                    std::lock_guard lock(mutex_);
                    pointLight_ = std::move(light);
                    answered_ = request.pickSerial;
                }
                if (wake_) wake_();
            }
            {
                // Rest: a new request ends this wait.
                std::unique_lock lock(mutex_);
                refining_ = false;
                if (request.restImage && !rest_)
                    changed_.wait_for(lock, stop, std::chrono::milliseconds(400), [&] { return serial_ != serial; });
                if (serial_ != serial) continue;
            }
            if (stop.stop_requested()) return;
            if (request.restImage && !request.orthographic && !restFrame()) renderAtRest(request, serial, stop);
            done = serial;
            {
                std::lock_guard lock(mutex_);
                if (serial_ == serial) working_ = false;
            }
            if (wake_) wake_();
        } catch (const Cancelled&) {
            if (live && !(held.scene == request.scene && held.estimate == request.estimate)) live.reset();
        } catch (const std::exception& error) {
            {
                std::lock_guard lock(mutex_);
                error_ = error.what();
            }
            done = serial;
            {
                std::lock_guard lock(mutex_);
                owed_ = false;
            }
            if (wake_) wake_();
        }
    }
}

}  // namespace relamp::ui
