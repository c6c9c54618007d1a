#include "radiance/round_sheets.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/statistics.h"
#include "radiance/seen_past.h"

namespace relamp {
namespace {

constexpr float tolerance = 0.0015f;  ///< of the diagonal: a surface from points of photographs
constexpr double ofRadius = 0.08;     ///< the same, of the surface's radius at most
constexpr float clearance = 0.02f;    ///< of the diagonal: between a missing surface and what is seen past it
constexpr float differs = 0.3f;       ///< log ratio: not what lies behind
constexpr float alikeBehind = 0.1f;   ///< log ratio: what lies behind
constexpr float agrees = 0.25f;       ///< log ratio between views of one side
constexpr double leastCosine = 0.15;  ///< grazing views tell nothing
constexpr float leastFacing = 0.7f;   ///< cosine between normals of mesh and surface
constexpr double bulge = 0.5;         ///< of the height: how far what fills a shade stands out of it
/// Views that show something else than what lies behind, over those that do not.
constexpr int leastScore = 1, sureScore = 2;
constexpr double beyond = 0.15;       ///< of the height that the mesh has, on either end
constexpr float halfShell = 0.0005f;  ///< of the diagonal: half of the thickness
constexpr size_t mostSurfaces = 8;
constexpr size_t leastCells = 60;
constexpr float leastPart = 0.03f;     ///< of the cells that the mesh covers
constexpr double leastCovered = 0.35;  ///< of the surface by the mesh
constexpr double leastTogether = 0.8;  ///< by mesh and patch: bodies that bulge about a cone stay as they are
constexpr int mostCells = 1500;        ///< along either side
constexpr int shred = 3;               ///< cells: half width of what is too narrow to be a surface
constexpr int slit = 4;                ///< cells: half width of what is closed
constexpr int overlap = 2;             ///< cells by which a patch reaches under the mesh
constexpr int stride = 2;              ///< cells between vertices

/// A map over heights (rows) and angles (columns, closed) of a surface of revolution.
struct Cells {
    int rows = 0, columns = 0;
    std::vector<uint8_t> value;
    Cells(int rowCount, int columnCount)
        : rows(rowCount), columns(columnCount), value(size_t(rows) * size_t(columns)) {}
    size_t index(int row, int column) const {
        return size_t(row) * size_t(columns) + size_t((column % columns + columns) % columns);
    }
    bool at(int row, int column) const { return row >= 0 && row < rows && value[index(row, column)] != 0; }
    size_t count() const { return size_t(std::count(value.begin(), value.end(), 1)); }

    /// Cells with more than `least` of the (2 reach + 1)^2 around.
    Cells around(int reach, int least) const {
        Cells result(rows, columns);
        parallelFor(size_t(rows), 8, [&](size_t row) {
            for (int column = 0; column < columns; ++column) {
                int sum = 0;
                for (int y = -reach; y <= reach; ++y)
                    for (int x = -reach; x <= reach; ++x) sum += at(int(row) + y, column + x);
                result.value[result.index(int(row), column)] = sum > least;
            }
        });
        return result;
    }
    Cells grown(int reach) const { return around(reach, 0); }
    Cells shrunk(int reach) const { return around(reach, (2 * reach + 1) * (2 * reach + 1) - 1); }
};

class Completion {
public:
    Completion(const Scene& scene, const Capture& capture, const SeenPast& past, const FoundRevolution& found)
        : scene_(scene),
          capture_(capture),
          past_(past),
          surface_(found.surface),
          low_(found.low),
          high_(found.high),
          near_(std::min(double(tolerance * scene.diagonal),
                         ofRadius * found.surface.radiusAt((found.low + found.high) / 2))) {
        const DVec3 middle = surface_.at((low_ + high_) / 2, 0);
        std::vector<double> pixel;
        for (const View& view : capture.views)
            pixel.push_back(glm::length(middle - view.camera.position()) / std::max(view.camera.focalX, 1e-9));
        const double height = high_ - low_;
        first_ = low_ - beyond * height;
        const double last = high_ + beyond * height,
                     round = 2 * piD * std::max(surface_.radiusAt(first_), surface_.radiusAt(last));
        cell_ = std::max({medianOf(std::move(pixel)), (last - first_) / mostCells, round / mostCells});
        rows_ = std::max(1, int((last - first_) / cell_));
        columns_ = std::max(3, int(round / cell_));
    }

    /// None where the mesh has too little of the surface; empty where nothing is missing.
    std::optional<SurfacePatch> patch() const {
        if (rows_ < 8 || columns_ < 16) return {};
        Cells covered(rows_, columns_), shown = covered, sure = covered, open = covered;
        forCells([&](int row, int column) { covered.value[covered.index(row, column)] = meshAt(row, column); });
        const Cells solid = covered.shrunk(shred).grown(shred);
        if (partCovered(solid) < leastCovered) return {};
        Cells shreds = covered;
        for (size_t i = 0; i < shreds.value.size(); ++i) shreds.value[i] = shreds.value[i] && !solid.value[i];
        forCells([&](int row, int column) {
            if (solid.at(row, column)) return;
            const int score = scoreOf(row, column, shreds);
            shown.value[shown.index(row, column)] = score >= leastScore;
            sure.value[sure.index(row, column)] = score >= sureScore;
            open.value[open.index(row, column)] = score < 0;
        });
        Cells missing = shown.around(1, 4);
        for (size_t i = 0; i < missing.value.size(); ++i) missing.value[i] = missing.value[i] && !solid.value[i];
        missing = joined(missing, solid.grown(overlap), sure);
        missing = closed(missing, solid, open);
        const size_t cells = missing.count();
        if (cells < leastCells || float(cells) < leastPart * float(solid.count())) return SurfacePatch{};
        Cells whole = missing;
        for (size_t i = 0; i < whole.value.size(); ++i) whole.value[i] |= solid.value[i];
        if (partCovered(whole) < leastTogether) return SurfacePatch{};
        SurfacePatch result = shell(missing, solid);
        result.replaced = replacedBy(missing, solid);
        result.area = areaOf(missing);
        return result;
    }

private:
    double heightOf(double row) const { return first_ + (row + 0.5) * cell_; }
    double angleOf(double column) const { return 2 * piD * column / columns_; }
    DVec3 pointOf(double row, double column) const { return surface_.at(heightOf(row), angleOf(column)); }

    template <class Function>
    void forCells(const Function& function) const {
        parallelFor(size_t(rows_), 1, [&](size_t row) {
            if (surface_.radiusAt(heightOf(double(row))) <= 0) return;
            for (int column = 0; column < columns_; ++column) function(int(row), column);
        });
    }

    /// Part of the surface that cells cover, of the heights that the mesh reaches: rounded edges of tables are a
    /// quarter of a cylinder and no sheet.
    double partCovered(const Cells& cells) const {
        size_t of = 0, with = 0;
        for (int row = 0; row < rows_; ++row) {
            if (heightOf(row) < low_ || heightOf(row) > high_) continue;
            of += size_t(columns_);
            for (int column = 0; column < columns_; ++column) with += cells.at(row, column);
        }
        return double(with) / double(std::max<size_t>(1, of));
    }

    float areaOf(const Cells& cells) const {
        double sum = 0;
        for (int row = 0; row < rows_; ++row)
            for (int column = 0; column < columns_; ++column)
                if (cells.at(row, column)) sum += surface_.radiusAt(heightOf(row));
        return float(sum * 2 * piD / columns_ * cell_ * std::sqrt(1 + surface_.slope * surface_.slope));
    }

    bool meshAt(int row, int column) const {
        const DVec3 p = pointOf(row, column), n = surface_.normal(angleOf(column));
        const float reach = float(3 * near_);
        const Hit hit = scene_.cameraTracer->closest({Vec3(p + double(reach) * n), Vec3(-n), 0, 2 * reach});
        return hit && std::abs(glm::dot(scene_.mesh.faceNormal(hit.triangle), Vec3(n))) > leastFacing;
    }

    /// The cell of a point close to the surface.
    std::optional<std::pair<int, int>> cellOf(const DVec3& p) const {
        if (std::abs(surface_.distance(p)) > 3 * near_) return {};
        const double turn = surface_.angle(p) / (2 * piD);
        return std::pair(int(std::floor((surface_.height(p) - first_) / cell_)),
                         int(std::floor((turn - std::floor(turn)) * columns_)));
    }

    /// Whether anything but shreds of the surface lies on the ray.
    bool hidden(const Vec3& eye, const Vec3& ray, float to, const Cells& shreds) const {
        float from = 0;
        for (int layers = 0; layers < 8; ++layers) {
            const Hit hit = scene_.cameraTracer->closest({eye, ray, from, to});
            if (!hit) return false;
            const auto cell = cellOf(DVec3(eye + hit.distance * ray));
            if (!cell || !shreds.at(cell->first, cell->second)) return true;
            from = hit.distance * (1 + 1e-6f) + 0.25f * scene_.tracer->surfaceOffset();
        }
        return true;
    }

    /// Whether the near wall hides the far one.
    bool behindNearWall(const DVec3& eye, const DVec3& direction, double distance) const {
        const auto meets = surface_.meets(eye, direction);
        if (!meets) return false;
        for (const double t : {meets->first, meets->second}) {
            if (!(t > 0) || t > distance - 8 * near_) continue;
            const double h = surface_.height(eye + t * direction);
            if (h > low_ && h < high_ && surface_.radiusAt(h) > 0) return true;
        }
        return false;
    }

    /// Score of the photographs for a surface at the cell; 0 where views of one side do not agree.
    int scoreOf(int row, int column, const Cells& shreds) const {
        const DVec3 p = pointOf(row, column), n = surface_.normal(angleOf(column));
        int score = 0;
        std::array<std::vector<float>, 2> luminances;  // of views of either side
        for (size_t i = 0; i < capture_.views.size(); ++i) {
            const Camera& camera = capture_.views[i].camera;
            const Image& image = capture_.views[i].image;
            const DVec3 eye = camera.position();
            const double distance = glm::length(p - eye);
            const DVec3 direction = (p - eye) / distance;
            const double cosine = glm::dot(direction, n);
            if (std::abs(cosine) < leastCosine) continue;
            const std::optional<Vec2> pixel = camera.project(p);
            if (!pixel ||
                !(pixel->x >= 0 && pixel->y >= 0 && pixel->x < float(image.width) && pixel->y < float(image.height)))
                continue;
            const int x = int(pixel->x), y = int(pixel->y);
            if (!image.usableAt(x, y)) continue;
            const Vec3 ray(direction);
            // Where the mesh is a little off it lies close behind, and differs for that reason alone.
            const float past = float(distance) + clearance * scene_.diagonal;
            if (hidden(Vec3(eye), ray, past, shreds) || (cosine > 0 && behindNearWall(eye, direction, distance)))
                continue;
            const Rgb shown = image.at(x, y);
            luminances[cosine > 0].push_back(std::log(std::max(luminance(shown), past_.floor())));
            const std::optional<float> off = past_.difference(i, ray, float(distance + 3 * near_), shown);
            if (off) score += *off > differs ? 1 : *off < alikeBehind ? -1 : 0;
        }
        bool agreeing = false;
        for (std::vector<float>& side : luminances) {
            if (side.size() < 2) continue;
            std::sort(side.begin(), side.end());
            if (side.back() - side.front() > 4 * agrees) return 0;
            agreeing |= spreadOf(side) < agrees;
        }
        return agreeing ? score : 0;
    }
    static float spreadOf(const std::vector<float>& values) {
        float sum = 0;
        for (size_t i = 0; i < values.size(); ++i)
            for (size_t k = 0; k < i; ++k) sum += std::abs(values[i] - values[k]);
        return sum / (0.5f * float(values.size() * (values.size() - 1)));
    }

    /// Connected cells that touch `to` and of which half are sure, without small ones.
    static Cells joined(const Cells& cells, const Cells& to, const Cells& sure) {
        Cells result(cells.rows, cells.columns), visited = result;
        for (int row = 0; row < cells.rows; ++row)
            for (int column = 0; column < cells.columns; ++column) {
                if (!cells.at(row, column) || visited.at(row, column)) continue;
                std::vector<std::pair<int, int>> region{{row, column}};
                visited.value[visited.index(row, column)] = 1;
                bool touches = false;
                size_t sureCells = 0;
                for (size_t i = 0; i < region.size(); ++i) {
                    const auto [y, x] = region[i];
                    touches |= to.at(y, x);
                    sureCells += sure.at(y, x);
                    for (const auto& [dy, dx] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
                        if (!cells.at(y + dy, x + dx) || visited.at(y + dy, x + dx)) continue;
                        visited.value[visited.index(y + dy, x + dx)] = 1;
                        region.push_back({y + dy, x + dx});
                    }
                }
                if (!touches || region.size() < leastCells || 2 * sureCells < region.size()) continue;
                for (const auto& [y, x] : region) result.value[result.index(y, x)] = 1;
            }
        return result;
    }

    /// Without slits and small holes, but those through which photographs see.
    static Cells closed(const Cells& missing, const Cells& solid, const Cells& open) {
        Cells all = missing;
        const Cells near = missing.grown(slit);
        for (size_t i = 0; i < all.value.size(); ++i) all.value[i] |= solid.value[i];
        Cells result = all.grown(slit).shrunk(slit);
        for (size_t i = 0; i < all.value.size(); ++i)
            result.value[i] =
                missing.value[i] || (result.value[i] && near.value[i] && !solid.value[i] && !open.value[i]);
        return result;
    }

    /// Two layers over the missing cells and a little under the mesh around, with smooth borders (marching squares).
    SurfacePatch shell(const Cells& missing, const Cells& solid) const {
        Cells all = missing;
        const Cells around = missing.grown(overlap);
        for (size_t i = 0; i < all.value.size(); ++i) all.value[i] |= around.value[i] && solid.value[i];
        const int rows = rows_ / stride, columns = columns_ / stride;
        const auto field = [&](int row, int column) {
            float sum = 0;
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x) sum += all.at(row * stride + y, (column % columns) * stride + x);
            return sum / 9 - 0.5f;
        };
        // The last column joins the first one: its cells may be a little wider.
        const auto place = [&](float row, float column) {
            const double turn = 2 * piD * double(column) / columns;
            return std::pair(surface_.at(heightOf(double(row) * stride), turn), surface_.normal(turn));
        };
        SurfacePatch patch;
        std::vector<std::pair<DVec3, DVec3>> points;
        std::map<std::array<int, 4>, uint32_t> numbers;
        const auto vertex = [&](int row, int column, int toRow, int toColumn) {
            if (std::pair(toRow, toColumn) < std::pair(row, column)) {
                std::swap(row, toRow);
                std::swap(column, toColumn);
            }
            const auto [entry, isNew] =
                numbers.try_emplace({row, column % columns, toRow, toColumn % columns}, uint32_t(points.size()));
            if (isNew) {
                const float a = field(row, column), b = field(toRow, toColumn), t = a == b ? 0 : a / (a - b);
                points.push_back(
                    place(float(row) + t * float(toRow - row), float(column) + t * float(toColumn - column)));
            }
            return entry->second;
        };
        for (int row = 0; row + 1 < rows; ++row)
            for (int column = 0; column < columns; ++column) {
                const std::array<std::pair<int, int>, 4> corners{
                    {{row, column}, {row, column + 1}, {row + 1, column + 1}, {row + 1, column}}};
                std::vector<uint32_t> polygon;
                for (size_t k = 0; k < 4; ++k) {
                    const auto [y, x] = corners[k];
                    const auto [ny, nx] = corners[(k + 1) % 4];
                    const bool in = field(y, x) > 0, nextIn = field(ny, nx) > 0;
                    if (in) polygon.push_back(vertex(y, x, y, x));
                    if (in != nextIn) polygon.push_back(vertex(y, x, ny, nx));
                }
                for (size_t k = 2; k < polygon.size(); ++k)
                    patch.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
            }
        const double half = double(halfShell * scene_.diagonal);
        for (const double side : {half, -half})
            for (const auto& [p, n] : points) patch.positions.push_back(Vec3(p + side * n));
        const auto count = uint32_t(points.size());
        for (size_t t = 0, end = patch.triangles.size(); t < end; ++t) {
            const auto [a, b, c] = patch.triangles[t];
            patch.triangles.push_back({count + a, count + c, count + b});
        }
        return patch;
    }

    /// Triangles near the surface that lie in the patch: what is left of a sheet in shreds.
    std::vector<uint32_t> replacedBy(const Cells& missing, const Cells& solid) const {
        const Cells in = missing.grown(shred);
        std::vector<uint32_t> result;
        for (uint32_t t = 0; t < scene_.mesh.triangles.size(); ++t) {
            const Triangle& corners = scene_.mesh.triangles[t];
            const bool isShred = std::all_of(corners.begin(), corners.end(), [&](uint32_t v) {
                const auto cell = cellOf(DVec3(scene_.mesh.positions[v]));
                return cell && in.at(cell->first, cell->second) && !solid.at(cell->first, cell->second);
            });
            if (isShred) result.push_back(t);
        }
        return result;
    }

    const Scene& scene_;
    const Capture& capture_;
    const SeenPast& past_;
    const RevolutionSurface surface_;
    double low_, high_;  ///< metres: heights between which the mesh has the surface
    double near_;        ///< metres: tolerance
    double first_ = 0;   ///< metres: height of the first row's lower border
    double cell_ = 0;    ///< metres
    int rows_ = 0, columns_ = 0;
};

}  // namespace

std::vector<RoundSheet> roundSheets(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                    Progress& progress) {
    std::vector<RoundSheet> sheets;
    std::vector<uint8_t> taken(scene.mesh.vertexCount(), 0);
    const SeenPast past(scene, capture, samples);
    progress.begin("Surfaces that the mesh lacks", mostSurfaces);
    for (size_t i = 0; i < mostSurfaces; ++i, progress.advance()) {
        const std::optional<FoundRevolution> found = findRevolution(scene, taken, tolerance * scene.diagonal);
        if (!found) break;
        for (const uint32_t v : found->vertices) taken[v] = 1;
        if (std::optional<SurfacePatch> patch = Completion(scene, capture, past, *found).patch())
            sheets.push_back({found->surface, found->low, found->high, std::move(*patch)});
    }
    return sheets;
}

std::vector<uint32_t> withFilling(const RoundSheet& sheet, const Scene& scene, const std::vector<uint8_t>& stays,
                                  const std::vector<uint32_t>& triangles) {
    const double height = sheet.high - sheet.low, near = double(tolerance * scene.diagonal);
    double sum = 0;
    for (const uint32_t t : triangles)
        sum += sheet.surface.height(DVec3(scene.mesh.positions[scene.mesh.triangles[t][0]]));
    // It stands out of the opening, which is at their end.
    const bool atLow = sum < 0.5 * (sheet.low + sheet.high) * double(triangles.size());
    const double low = sheet.low - (atLow ? bulge * height : 0), high = sheet.high + (atLow ? 0 : bulge * height);
    const auto within = [&](uint32_t v) {
        const DVec3 p(scene.mesh.positions[v]);
        const double h = sheet.surface.height(p);
        return !stays[v] && h > low && h < high && sheet.surface.distance(p) < -near;
    };
    const DVec3 out = atLow ? -sheet.surface.axis : sheet.surface.axis;
    const auto touches = [&](uint32_t t) {
        const Triangle& corners = scene.mesh.triangles[t];
        return glm::dot(DVec3(scene.mesh.faceNormal(t)), out) > 0 &&
               std::any_of(corners.begin(), corners.end(), within);
    };
    if (std::none_of(triangles.begin(), triangles.end(), touches)) return triangles;
    std::vector<uint32_t> result = triangles;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
        if (touches(t)) result.push_back(t);
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
}

const RoundSheet* sheetAbout(const std::vector<RoundSheet>& sheets, const ProxyLight& ball) {
    const RoundSheet* best = nullptr;
    double largest = 0;
    for (const RoundSheet& sheet : sheets) {
        const double at = sheet.surface.height(ball.centre), room = 2 * double(ball.radius);
        if (!(sheet.surface.distance(ball.centre) < 0) || at < sheet.low - room || at > sheet.high + room) continue;
        const double area = (sheet.high - sheet.low) * sheet.surface.radiusAt(0.5 * (sheet.low + sheet.high));
        if (area > largest) {
            largest = area;
            best = &sheet;
        }
    }
    return best;
}

std::vector<const RoundSheet*> sheetsAbout(const std::vector<RoundSheet>& sheets,
                                           const std::vector<ProxyLight>& balls) {
    std::vector<const RoundSheet*> about;
    for (const ProxyLight& ball : balls) {
        const RoundSheet* sheet = sheetAbout(sheets, ball);
        if (sheet && std::find(about.begin(), about.end(), sheet) == about.end()) about.push_back(sheet);
    }
    return about;
}

}  // namespace relamp
