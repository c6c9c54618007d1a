#include "scene/ray_tracer.h"

#include "base/box.h"
#include "base/error.h"

#if RELAMP_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace relamp {

struct RayTracer::Embree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    ~Embree() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

namespace {

[[noreturn]] void refuse(RTCError error) {
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw OutOfResources("the ray tracer ran out of memory");
    throw Error("the ray tracer could not be started (Embree error {})", int(error));
}

}  // namespace

RayTracer::RayTracer(const Mesh& mesh, float diagonal, For rays) : embree_(std::make_unique<Embree>()) {
    Embree& e = *embree_;
    e.device = rtcNewDevice("start_threads=0,set_affinity=0");
    if (!e.device) refuse(rtcGetDeviceError(nullptr));
    e.scene = rtcNewScene(e.device);
    rtcSetSceneFlags(e.scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(e.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, std::max<size_t>(mesh.vertexCount(), 1)));
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   12, std::max<size_t>(mesh.triangles.size(), 1)));
    if (!positions || !indices) {
        rtcReleaseGeometry(geometry);
        refuse(RTC_ERROR_OUT_OF_MEMORY);
    }
    Box box;
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        const Vec3 p = mesh.positions[v];
        for (int k = 0; k < 3; ++k) positions[3 * v + k] = p[k];
    }
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            indices[3 * t + k] = mesh.triangles[t][k];
            box.grow(mesh.positions[mesh.triangles[t][k]]);
        }
    // Without area a triangle is never hit, and the others keep their numbers.
    if (rays == For::light)
        for (const uint32_t t : mesh.shadowless)
            if (t < mesh.triangles.size()) indices[3 * t + 1] = indices[3 * t + 2] = indices[3 * t];
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(e.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(e.scene);
    if (const RTCError error = rtcGetDeviceError(e.device); error != RTC_ERROR_NONE) refuse(error);
    if (!mesh.triangles.empty()) {
        const float size = diagonal > 0 ? diagonal : box.diagonal();
        const float reach = std::max(maxChannel(glm::abs(box.min)), maxChannel(glm::abs(box.max)));
        surfaceOffset_ = std::max(1e-5f * size, 4e-7f * reach);
    }
}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;
RayTracer& RayTracer::operator=(RayTracer&&) noexcept = default;

namespace {

/// A ray that hits nothing, for one that has no place or direction: Embree ends the process for those.
const Ray nowhere{Vec3(0), Vec3(0, 0, 1), 1, 0.5f};

/// Within what Embree takes; false for what is no number.
bool isUsable(const Ray& ray) {
    constexpr float most = 1e18f;
    bool good = ray.near >= 0;
    for (int k = 0; k < 3; ++k) good &= std::abs(ray.origin[k]) < most && std::abs(ray.direction[k]) < most;
    return good;
}

template <class R>
void fill(R& r, const Ray& given, unsigned id) {
    const Ray& ray = isUsable(given) ? given : nowhere;
    r.org_x = ray.origin.x;
    r.org_y = ray.origin.y;
    r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x;
    r.dir_y = ray.direction.y;
    r.dir_z = ray.direction.z;
    r.tnear = ray.near;
    r.tfar = ray.far;
    r.time = 0;
    r.mask = ~0u;
    r.id = id;
    r.flags = 0;
}

void fill8(RTCRay8& r, int i, const Ray& given) {
    const Ray& ray = isUsable(given) ? given : nowhere;
    r.org_x[i] = ray.origin.x;
    r.org_y[i] = ray.origin.y;
    r.org_z[i] = ray.origin.z;
    r.dir_x[i] = ray.direction.x;
    r.dir_y[i] = ray.direction.y;
    r.dir_z[i] = ray.direction.z;
    r.tnear[i] = ray.near;
    r.tfar[i] = ray.far;
    r.time[i] = 0;
    r.mask[i] = ~0u;
    r.id[i] = unsigned(i);
    r.flags[i] = 0;
}

#if RELAMP_EMBREE_MAJOR < 4
struct Context : RTCIntersectContext {
    Context() { rtcInitIntersectContext(this); }
};
#endif

}  // namespace

Hit RayTracer::closest(const Ray& ray) const {
    RTCRayHit r;
    fill(r.ray, ray, 0);
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RELAMP_EMBREE_MAJOR >= 4
    rtcIntersect1(embree_->scene, &r);
#else
    Context context;
    rtcIntersect1(embree_->scene, &context, &r);
#endif
    Hit hit;
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.triangle = r.hit.primID;
    hit.distance = r.ray.tfar;
    hit.barycentric = {r.hit.u, r.hit.v};
    return hit;
}

bool RayTracer::occluded(const Ray& ray) const {
    RTCRay r;
    fill(r, ray, 0);
#if RELAMP_EMBREE_MAJOR >= 4
    rtcOccluded1(embree_->scene, &r);
#else
    Context context;
    rtcOccluded1(embree_->scene, &context, &r);
#endif
    return r.tfar < 0;
}

uint32_t RayTracer::occluded8(std::span<const Ray> rays) const {
    alignas(32) int valid[8];
    RTCRay8 r;
    const int count = int(rays.size());
    for (int i = 0; i < 8; ++i) {
        valid[i] = i < count ? -1 : 0;
        fill8(r, i, rays[size_t(std::min(i, count - 1))]);
    }
#if RELAMP_EMBREE_MAJOR >= 4
    rtcOccluded8(valid, embree_->scene, &r);
#else
    Context context;
    rtcOccluded8(valid, embree_->scene, &context, &r);
#endif
    uint32_t bits = 0;
    for (int i = 0; i < count; ++i)
        if (r.tfar[i] < 0) bits |= 1u << i;
    return bits;
}

void RayTracer::closest8(std::span<const Ray> rays, std::span<Hit> hits) const {
    alignas(32) int valid[8];
    RTCRayHit8 r;
    const int count = int(rays.size());
    for (int i = 0; i < 8; ++i) {
        valid[i] = i < count ? -1 : 0;
        fill8(r.ray, i, rays[size_t(std::min(i, count - 1))]);
        r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
#if RELAMP_EMBREE_MAJOR >= 4
    rtcIntersect8(valid, embree_->scene, &r);
#else
    Context context;
    rtcIntersect8(valid, embree_->scene, &context, &r);
#endif
    for (int i = 0; i < count; ++i) {
        hits[i] = Hit{};
        if (r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        hits[i].triangle = r.hit.primID[i];
        hits[i].distance = r.ray.tfar[i];
        hits[i].barycentric = {r.hit.u[i], r.hit.v[i]};
    }
}

}  // namespace relamp
