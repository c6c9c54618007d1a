// What a LiveScene holds between edits. Only live_*.cpp include this.
#pragma once
#include "relight/live/gloss.h"
#include "relight/live/near_device.h"
#include "transport/bounce.h"

namespace relamp {

struct LiveScene::State {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
    LiveOptions options;
    LiveGrid grid;
    Look look;
    Eye eye;

    PartsApart apart;  ///< components that were ever moved; they stay out of the bake
    EditedGeometry geometry;
    std::shared_ptr<const ClosedMesh> closed;  ///< of the last look: the steps of a drag share it
    std::vector<std::string> partNames;        ///< of the parts: which one is the same through edits
    LiveVertices vertices;
    LiveOccluders occluders;
    std::shared_ptr<const std::vector<int>> emitterOfTriangle;

    LiveMatte matte;
    LiveCarried carried;
    std::vector<NearEmitter> near;
    NearPlace nearPlace;
    NearLevels nearLevels;    ///< of the capture's vertices that stay in place
    DeviceBlockers blockers;  ///< kept while a device is in use
    LiveGloss gloss;
    std::vector<Rgb> distantMatte;  ///< per vertex, before exposure and tint

    BounceRays bounceRays;     ///< of the capture's mesh; empty where the estimate holds no bounced light
    std::vector<float> lobesReflect;  ///< hemisphericalAlbedos of the basis
    std::vector<Rgb> bounced;  ///< per vertex of the capture, follows the direct light a few steps an image

    std::shared_ptr<const DistantLight> unturned;  ///< the environment of the look's source alone
    std::shared_ptr<const DistantLight> plain;     ///< turned, before exposure and tint
    std::shared_ptr<const DistantLight> distant;   ///< with them
    Rgb gain{1};
    LiveLight light;
    EnvironmentPyramid pyramid;
    bool pyramidStale = true;  ///< of another environment

    std::vector<LivePart> stirred;   ///< where parts moved from and to; empty when that does not tell what changed
    std::vector<LivePart> released;  ///< spheres of components that just became movable
    bool newGeometry = true, newLight = true, newEye = true, newValues = true;  ///< what the next slice has to answer
    bool finished = false;
    LiveReport report;
    std::shared_ptr<const LiveFrame> frame;

    State(std::shared_ptr<const Scene> scene_, std::shared_ptr<const Estimate> estimate_, const LiveOptions& options_);

    /// Takes over geometry and emitters of a look.
    void takeGeometry(const Look& next, EditedGeometry edited, PartsApart nextApart);
    /// The environment of a look's source, the present one when it is the same.
    std::shared_ptr<const DistantLight> unturnedOf(const EnvironmentLook& next) const;
    void takeEnvironment(const EnvironmentLook& next, std::shared_ptr<const DistantLight> nextUnturned);
    PartsApart apartOf(const Look& next) const;

    /// Builds the pyramid when it is needed: a matte scene never asks.
    GlossInputs glossInputs();
    void coarse(Progress& progress);
    void followBlockers();
    bool refineBatch(Progress& progress);  ///< false: nothing left
    /// Environment on matte vertices and what gloss has to take again.
    void sumLight();
    void makeFrame();
    /// Per vertex 1 where an emitter sends light towards the eye: one that shines to one side is black from behind.
    std::vector<uint8_t> shiningAtEye() const;
    /// Takes bounced light on from the last image's towards that of the given direct light (per vertex, as a white
    /// matte surface shows it).
    void followBounces(const std::vector<Rgb>& direct);
    Rgb albedo(size_t vertex) const;
    /// By which a vertex passes light on to others: matte part and what lobes reflect of even light.
    Rgb bouncingAlbedo(size_t vertex) const;
};

}  // namespace relamp
