// Relighting that follows the hand: radiance per vertex of the edited scene, at once from few samples, refined at rest.
// What the viewport shows between edits; final frames come from renderFrame. Both evaluate the forward model (2) and a
// test holds them together.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "relight/relit_scene.h"
#include "transport/transport_device.h"

namespace relamp {

class NearDevice;
class ShadowDevice;

/// What a graphics card can do for a LiveScene; null: the processor does it.
struct LiveDevices {
    std::shared_ptr<TransportDevice> sums;  ///< light of the environment over stored transport
    std::shared_ptr<NearDevice> near;       ///< form factors of emitters (relight/live/near_device.h)
    std::shared_ptr<ShadowDevice> shadows;  ///< of parts in the environment (relight/live/shadow_device.h)
};

struct LiveOptions {
    int gridSide = 32;    ///< side of the direction square of the baked transport; 64 for sharp gloss
    float error = 0.01f;  ///< terms are kept until no test environment is off by more than this fraction
    uint64_t seed = 1;
    std::filesystem::path
        cacheFolder{};         ///< baked transport is kept here and found again by its inputs; empty: nowhere
    LiveDevices devices{};     ///< each used where it is faster than the processor
    bool forceDevice = false;  ///< also where it is slower
};

/// From where the scene is seen: glossy light depends on it, matte light does not.
struct Eye {
    Vec3 position{0};
    Vec3 forward{0, 1, 0};      ///< unit
    bool orthographic = false;  ///< then every ray runs along `forward`
    float halfAngle = 0;        ///< radians, perspective: half the opening of the cone about `forward` that holds the
                                ///< image; 0: everything may be in it
};

/// What an image cost and what it left out.
struct LiveReport {
    double bakeSeconds = 0;     ///< transport of the environment, once a scene
    double lightMs = 0;         ///< last change of the environment or of a power
    double moveMs = 0;          ///< last coarse answer to a moved emitter
    size_t lightBetween = 0;    ///< there: vertices of the last emitter whose light lies between that of others
    double eyeMs = 0;           ///< last glossy pass
    size_t bytesPerVertex = 0;  ///< of stored transport
    size_t storeBytes = 0;      ///< of the coefficients alone, which every change of the environment streams once
    float termsPerVertex = 0;   ///< Haar coefficients kept
    size_t glossyVertices = 0;  ///< shaded in the last glossy pass
    size_t glossyOutside = 0;   ///< that face the eye but lie outside the image: not shaded until they come into it
    size_t cachedBlocks = 0;    ///< of the bake, found in the cache folder
    std::string device;         ///< that sums light; empty: the processor
    double cpuApplyMs = 0;      ///< one sum over the store on the processor, measured after the bake
    double deviceApplyMs = 0;   ///< the same on the device; 0: there is none, or it failed
    std::string nearDevice;     ///< that computes the near field of what moves; empty: the processor
    double cpuNearMs = 0;       ///< an emitter's first samples at all vertices, measured after the bake; 0: no device
    double deviceNearMs = 0;    ///< the same on the device; 0: there is none, or it failed
    std::string shadowDevice;   ///< that traces a part's shadow in the environment; empty: the processor
    double cpuShadowMs = 0;     ///< a part's whole shadow from a ray a cell, measured at the first one; 0: no device
    double deviceShadowMs = 0;  ///< the same on the device; 0: there is none, or it failed
    std::vector<LeftOut> leftOut;
};

/// One image: per-vertex values over the edited mesh. Never changes afterwards.
struct LiveFrame {
    std::shared_ptr<const Mesh> mesh;  ///< the capture's vertices in order, copies and added shapes behind; the pointer
                                       ///< changes when geometry does
    std::shared_ptr<const std::vector<uint32_t>>
        origin;  ///< per vertex: the capture's vertex it is or was copied from; ~0u on added shapes
    std::shared_ptr<const std::vector<int>> emitterOfTriangle;  ///< index into emitterRadiance; -1: none
    std::vector<std::string> emitterIds;                        ///< recovered ones in order, then added ones
    std::vector<Rgb> emitterRadiance;                           ///< 0 when off
    std::vector<Rgb> radiance;  ///< per vertex towards the eye; an emitter's own radiance on its surface, 0
                                ///< behind one that shines to one side
    std::vector<std::vector<float>>
        formFactor;  ///< per emitter, per vertex: with shadows, times radiance it is what a white matte surface shows;
                     ///< of a shaping with colours their luminance
    std::vector<Rgb> distantMatte;                ///< per vertex: what a white matte surface shows of the environment
    std::shared_ptr<const DistantLight> distant;  ///< the environment in use, for the backdrop
    bool refined = false;                         ///< nothing left to improve
    LiveReport report;
};

/// Where the light at one surface point comes from.
struct PointLight {
    Vec3 point{0}, normal{0};
    Rgb fromEnvironment{0};        ///< part of the radiance towards the eye
    std::vector<Rgb> fromEmitter;  ///< per emitter
    DirectionGrid grid{32};
    std::vector<Rgb>
        incident;  ///< radiance that arrives, per cell of the grid; 0 below the horizon and where the scene blocks
    std::vector<Rgb> weights;  ///< per lobe of the basis
};

/// Holds the baked transport of one scene and the state of one look. Not thread-safe: one thread owns it; the frames it
/// gives may be kept and read anywhere. The same bits on any number of threads.
class LiveScene {
public:
    /// Bakes the transport. Cost about 0.1 ms a vertex and core. Throws Cancelled.
    LiveScene(std::shared_ptr<const Scene> scene, std::shared_ptr<const Estimate> estimate, const LiveOptions& options,
              Progress& progress);
    ~LiveScene();
    LiveScene(const LiveScene&) = delete;
    LiveScene& operator=(const LiveScene&) = delete;

    /// Takes the look over and marks what it changed; what did not change is kept. Throws Error as applyLook does, the
    /// state is then as it was.
    void setLook(const Look& look);
    void setEye(const Eye& eye);
    /// One slice of work of about `seconds`. The first slice after a change always ends in a whole image (from few
    /// samples when a geometry moved); later slices refine it. True when nothing is left to do. Throws Cancelled
    /// between slices of a few ms; the next call goes on.
    bool refine(double seconds, Progress& progress);
    /// The present image.
    std::shared_ptr<const LiveFrame> frame() const;
    /// Rays from one surface point of the present image's mesh. Cost: about 2000 rays.
    PointLight lightAt(uint32_t triangle, const Vec2& barycentric) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace relamp
