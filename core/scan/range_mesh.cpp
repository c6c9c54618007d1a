#include "scan/range_mesh.h"

#include "base/parallel.h"
#include "scene/ray_tracer.h"

namespace relamp {
namespace {

constexpr uint32_t noVertex = ~0u;

/// Whether an earlier view holds the surface at a point already.
bool heldBy(const RangeView& view, const DVec3& point, double slope, int step) {
    const auto pixel = view.camera->project(point);
    if (!pixel) return false;
    const int x = int(std::floor(pixel->x)), y = int(std::floor(pixel->y));
    if (x < 0 || y < 0 || x >= view.range->width || y >= view.range->height) return false;
    const auto found = double(view.range->distance[size_t(y) * size_t(view.range->width) + size_t(x)]);
    const double distance = glm::distance(point, view.camera->position());
    return found > 0 && std::abs(found - distance) < mostStep(*view.camera, distance, slope, step, view.noise);
}

/// Adds the triangles of one view on a grid of every `step`-th pixel.
class GridMesher {
public:
    GridMesher(const std::vector<RangeView>& views, size_t which, int step, double slope, Mesh& mesh)
        : views_(views), view_(views[which]), which_(which), step_(step), slope_(slope), mesh_(mesh) {}

    void add() {
        columns_ = view_.range->width / step_;
        rows_ = view_.range->height / step_;
        vertex_.assign(size_t(columns_) * size_t(rows_), noVertex);
        held_.assign(vertex_.size(), 0);
        parallelFor(vertex_.size(), 1024, [&](size_t i) {
            if (!(distanceAt(i) > 0)) return;
            for (size_t v = 0; v < which_ && !held_[i]; ++v) held_[i] = heldBy(views_[v], pointAt(i), slope_, step_);
        });
        for (int y = 0; y + 1 < rows_; ++y)
            for (int x = 0; x + 1 < columns_; ++x) addQuad(x, y);
    }

private:
    size_t pixelOf(size_t cell) const {
        const size_t x = cell % size_t(columns_), y = cell / size_t(columns_);
        return y * size_t(step_) * size_t(view_.range->width) + x * size_t(step_);
    }
    double distanceAt(size_t cell) const { return double(view_.range->distance[pixelOf(cell)]); }
    DVec3 pointAt(size_t cell) const {
        return view_.camera->position() + distanceAt(cell) * view_.range->directions[pixelOf(cell)];
    }
    bool joined(size_t a, size_t b, double apart) const {
        const double da = distanceAt(a), db = distanceAt(b);
        return da > 0 && db > 0 &&
               std::abs(da - db) <= mostStep(*view_.camera, std::min(da, db), slope_, apart * step_, view_.noise);
    }
    uint32_t vertexAt(size_t cell) {
        if (vertex_[cell] == noVertex) {
            vertex_[cell] = uint32_t(mesh_.positions.size());
            mesh_.positions.push_back(Vec3(pointAt(cell)));
        }
        return vertex_[cell];
    }
    void addTriangle(size_t a, size_t b, size_t c) {
        if (held_[a] + held_[b] + held_[c] >= 2) return;
        const uint32_t va = vertexAt(a), vb = vertexAt(b), vc = vertexAt(c);
        mesh_.triangles.push_back({va, vb, vc});
    }
    void addQuad(int x, int y) {
        // Counter-clockwise as the camera sees them, y down: a b over c d.
        const size_t a = size_t(y) * size_t(columns_) + size_t(x), b = a + 1, c = a + size_t(columns_), d = c + 1;
        const bool ab = joined(a, b, 1), ac = joined(a, c, 1), bd = joined(b, d, 1), cd = joined(c, d, 1);
        const bool ad = joined(a, d, 1.4142), bc = joined(b, c, 1.4142);
        const bool byFalling =
            ad && (!bc || std::abs(distanceAt(a) - distanceAt(d)) <= std::abs(distanceAt(b) - distanceAt(c)));
        if (byFalling) {
            if (ac && cd) addTriangle(a, c, d);
            if (ab && bd) addTriangle(a, d, b);
        } else if (bc) {
            if (ab && ac) addTriangle(a, c, b);
            if (bd && cd) addTriangle(b, c, d);
        }
    }

    const std::vector<RangeView>& views_;
    const RangeView& view_;
    size_t which_;
    int step_;
    double slope_;
    Mesh& mesh_;
    int columns_ = 0, rows_ = 0;
    std::vector<uint32_t> vertex_;
    std::vector<uint8_t> held_;
};

/// Drops small pieces and the vertices that no triangle uses; returns how many pieces went.
size_t dropIslands(Mesh& mesh, double least) {
    const std::vector<uint32_t> piece = connectedComponents(buildVertexGraph(mesh));
    std::vector<size_t> size(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) ++size[piece[t[0]]];
    const auto enough = size_t(least * double(mesh.triangles.size())) + 2;
    size_t dropped = 0;
    for (size_t count : size) dropped += count > 0 && count < enough;
    std::vector<uint32_t> kept(mesh.positions.size(), noVertex);
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    for (Triangle t : mesh.triangles) {
        if (size[piece[t[0]]] < enough) continue;
        for (uint32_t& v : t) {
            if (kept[v] == noVertex) {
                kept[v] = uint32_t(positions.size());
                positions.push_back(mesh.positions[v]);
            }
            v = kept[v];
        }
        triangles.push_back(t);
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return dropped;
}

}  // namespace

RangeMesh meshRanges(const std::vector<RangeView>& views, const RangeMeshOptions& options, Progress& progress) {
    RangeMesh out;
    size_t pixels = 0;
    for (const RangeView& view : views) pixels = std::max(pixels, view.range->count());
    out.step =
        std::max(1, int(std::ceil(std::sqrt(2 * double(pixels) / double(std::max<size_t>(1, options.triangles))))));
    progress.begin("Meshing", views.size() + 1);
    for (size_t v = 0; v < views.size(); ++v) {
        GridMesher(views, v, out.step, options.slope, out.mesh).add();
        progress.advance();
    }
    out.droppedIslands = dropIslands(out.mesh, options.leastIsland);
    if (out.mesh.triangles.empty())
        throw Error("no two neighbouring pixels have a place in space: are calibration and photographs of one scan?");
    out.mesh.normals = vertexNormalsFromFaces(out.mesh);
    progress.advance();
    return out;
}

Image coverageOf(const Mesh& mesh, const Camera& camera, Progress& progress) {
    const RayTracer tracer(mesh, 0, RayTracer::For::cameras);
    Image mask(camera.width, camera.height);
    const Vec3 eye(camera.position());
    progress.begin("Masking", size_t(camera.height));
    parallelFor(
        size_t(camera.height), 8,
        [&](size_t y) {
            for (int x = 0; x < camera.width; ++x) {
                const Vec3 toward = camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                if (tracer.closest({eye, toward})) mask.at(x, int(y)) = Rgb(1);
            }
        },
        &progress);
    return mask;
}

}  // namespace relamp
