// One thread that relights: it owns the live scene and always works on the latest request, never on a queue, so that
// the window never waits. At rest it renders a per-pixel image from the same eye, sharper with every pass.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "image/image_region.h"
#include "relight/frame.h"
#include "relight/live/live_scene.h"
#include "relight/relit_scene.h"

namespace relamp::ui {

/// What the window wants to see.
struct RelightRequest {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
    Look look;
    Camera eye;
    bool orthographic = false;
    std::filesystem::path cacheFolder;  ///< of baked transport; empty: none
    bool restImage = false;             ///< per-pixel image once nothing moves
    std::optional<ImageRegion> region;  ///< that it covers; none: the whole image
    bool dragging = false;              ///< the next step is near: no more is done than is looked at
    int64_t time = 0;                   ///< handed back with the image
    uint64_t pickSerial = 0;            ///< a new number asks about a new point
    uint32_t pickTriangle = 0;
    Vec2 pickBarycentric{0};
};

struct RelitImage {
    std::shared_ptr<const LiveFrame> image;
    int64_t time = 0;  ///< of the request that it answers
};
/// The same scene, look and eye.
bool sameImage(const RelightRequest& a, const RelightRequest& b);
bool sameEye(const RelightRequest& a, const RelightRequest& b);

class RelightWorker {
public:
    /// `wake` is called on the worker's thread whenever there is something new.
    /// `makeDevices` is called once on the worker's thread, before the first scene; what it gives is used where that is
    /// faster, or always when `forceDevice`. Empty, or null answers: the processor does it.
    explicit RelightWorker(std::function<void()> wake, std::function<LiveDevices()> makeDevices = {},
                           bool forceDevice = false);
    ~RelightWorker();

    /// The latest request wins; what did not change is kept.
    void request(RelightRequest request);
    /// Drops everything that belongs to the open document.
    void clear();

    /// The latest image. In a drag the next one is made when this one was taken.
    RelitImage frame() const;
    std::shared_ptr<const Frame> restFrame() const;
    /// The answer to the pick with this serial, once.
    std::optional<PointLight> takePointLight(uint64_t serial);
    /// What went wrong with the latest request, once ("" when nothing).
    std::string takeError();
    /// Work is left for the present request.
    bool working() const;
    /// The latest request was another image, and nothing of it has come yet.
    bool imageOwed() const;
    /// Coarse images are on their way: not counting the per-pixel image at rest.
    bool refining() const;

private:
    mutable std::mutex mutex_;
    mutable std::condition_variable_any changed_;
    std::function<void()> wake_;
    std::function<LiveDevices()> makeDevices_;
    bool forceDevice_;
    RelightRequest request_;
    uint64_t serial_ = 0;                                ///< of the latest request
    std::chrono::steady_clock::time_point changedAt_{};  ///< when another image was asked for
    std::shared_ptr<Progress> running_;                  ///< of the step in work, so that a new request can end it
    bool runningIsRest_ = false;
    bool owed_ = false;  ///< imageOwed()
    std::shared_ptr<const LiveFrame> frame_;
    int64_t frameTime_ = 0;
    mutable bool taken_ = true;  ///< frame_ was
    std::shared_ptr<const Frame> rest_;
    std::optional<PointLight> pointLight_;
    uint64_t answered_ = 0;
    std::string error_;
    /// Of the last image at rest, used by the thread alone: a large file is not read again for each.
    EnvironmentLook restEnvironment_;
    std::shared_ptr<const DistantLight> restDistant_;
    double restSecondsPerSample_ = 0;  ///< and pixel, of the last image at rest; 0: there was none
    bool working_ = false, refining_ = false;
    std::jthread thread_;

    void run(std::stop_token stop);
    /// Hands out what `live` shows of `request`, unless another scene was asked for meanwhile.
    void publish(const LiveScene& live, const RelightRequest& request, uint64_t serial, bool refined);
    /// So that the window's drawing has the processors, and the next step of a hand that moves. True when there is a
    /// newer request, or the end.
    bool waitUntilTaken(uint64_t serial, const std::stop_token& stop);
    void renderAtRest(const RelightRequest& request, uint64_t serial, const std::stop_token& stop);
};

}  // namespace relamp::ui
