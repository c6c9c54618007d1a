// Ratio frames from cameras that took no photograph: what the capture's photographs show of the surfaces seen there.
#pragma once
#include <filesystem>
#include <optional>

#include "capture/capture.h"
#include "capture/orientation.h"
#include "relight/frame.h"
#include "texture/photograph_geometry.h"

namespace relamp {

/// Photographs as light: each pixel over the albedo that the model has in it. Light is smooth where prints are not, so
/// it can be looked up from another camera without blurring them.
class OtherPhotographs {
public:
    /// `captured`: the light in which the views were photographed; kept as a reference.
    explicit OtherPhotographs(const RelitScene& captured) : captured_(captured) {}

    /// Takes a view with its pixels. Cost: two rays a pixel. Memory: 13 B a pixel. Throws Cancelled.
    void add(const View& view, Progress& progress);
    bool empty() const { return views_.empty(); }
    /// Radiance that counts as black (ratioFloor), the mean over the views.
    float floor() const { return floors_ / float(std::max<size_t>(1, views_.size())); }

    /// The photograph that a camera would have taken, as far as other views show it: rows from `first` on, as many as
    /// `old` has, which is the model as captured there. Usable where a view shows the pixel's surface. Views count by
    /// how finely and how squarely they see it, and less within three pixels of edges and near the image's rim. Where
    /// a coating reflects, the view that counts most is compared with the model of its own pixel, which `renderer`
    /// (of captured) makes. Cost: a ray a pixel and view. Bits do not depend on threads. Throws Cancelled.
    Image rows(const Camera& camera, int first, const Frame& old, const FrameRenderer& renderer,
               Progress& progress) const;

private:
    struct Seen {
        Camera camera;
        Image light;       ///< radiance over albedo
        Image photograph;  ///< empty where nothing glossy can be seen
        PhotographGeometry geometry;
    };
    /// A view that shows a surface point, and where.
    struct Sight {
        size_t view = 0;
        Vec2 pixel;
        float trust = 0, fineness = 0;
    };
    const RelitScene& captured_;
    std::vector<Seen> views_;
    float floors_ = 0;

    std::vector<Sight> sightsOf(const Vec3& point, const Vec3& normal) const;
    bool glossyAt(const Hit& hit) const;
};

/// The photographs of a capture by lighting state, read when they are first asked for; those of one state are held.
class StatePhotographs {
public:
    /// `state`: whose light frames without a view have; none: that of most views. Keeps references.
    StatePhotographs(const Capture& capture, const std::filesystem::path& folder, const CaptureFix& fix,
                     std::optional<size_t> state);
    std::optional<size_t> state() const { return state_; }
    /// Those of a state; none: of all views. `captured`: its light; kept as a reference. Good until the next call with
    /// another one. Throws Error as PhotographReader does, Cancelled.
    const OtherPhotographs& in(std::optional<size_t> state, const RelitScene& captured, Progress& progress);

private:
    const Capture& capture_;
    const std::filesystem::path& folder_;
    const CaptureFix& fix_;
    std::optional<size_t> state_;
    const RelitScene* of_ = nullptr;
    std::optional<OtherPhotographs> held_;
};

}  // namespace relamp
