#include "radiance/whole_shade.h"

#include <algorithm>
#include <cmath>

#include "base/statistics.h"

namespace relamp {
namespace {

constexpr float sheetTolerance = 0.0015f;                 ///< of the diagonal: a surface from points of photographs
constexpr double sheetOfRadius = 0.08;                    ///< the same, of the surface's radius at most
constexpr float alongSheet = 0.7f;                        ///< cosine between normals of mesh and surface
constexpr float sheetThickness = 0.001f;                  ///< of the diagonal, where nothing tells
constexpr double thinnestSheet = 0.3, thickestSheet = 3;  ///< of the usual thickness
constexpr int profileRows = 16, ringColumns = 24;
constexpr double wholeRing = 0.85;  ///< of its columns
constexpr double leastWhole = 0.4;  ///< of the sheet's height
constexpr double outside = 4.5;     ///< tolerances to which mesh belongs to the sheet
constexpr double inside = 9;        ///< the same to its inner side, where a reconstruction leaves shreds
constexpr double overRim = 12;      ///< tolerances that shreds stand out of the opening
constexpr double underMesh = 2;     ///< tolerances by which the sheet reaches under the mesh

/// The sheet's profile: heights counted from the rim.
class Profile {
public:
    Profile(const Scene& scene, size_t own, const RoundSheet& sheet, const RimCircle& rim, bool low)
        : scene_(scene), surface_(rim.surface), rim_(rim.height), up_(low ? 1 : -1) {
        length_ = up_ * ((low ? sheet.high : sheet.low) - rim.height);
        near_ = std::min(double(sheetTolerance * scene.diagonal),
                         sheetOfRadius * surface_.radiusAt((sheet.low + sheet.high) / 2));
        std::vector<std::vector<double>> off(profileRows);
        std::vector<std::vector<uint8_t>> ring(profileRows, std::vector<uint8_t>(ringColumns, 0));
        std::vector<double> spacing;
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
            const DVec3 p(scene.mesh.positions[v]);
            const double distance = surface_.distance(p);
            if (!scene.referenced[v] || std::abs(distance) > 3 * near_) continue;
            if (glm::dot(surface_.normalAt(p), DVec3(scene.mesh.normals[v])) < double(alongSheet)) continue;
            const int row = int(std::floor(heightOf(p) / length_ * profileRows));
            if (row < 0 || row >= profileRows) continue;
            const double turn = surface_.angle(p) / (2 * piD);
            ring[size_t(row)][size_t((turn - std::floor(turn)) * ringColumns) % ringColumns] = 1;
            if (v < own) off[size_t(row)].push_back(distance);
            spacing.push_back(double(scene.vertexSpacing[v]));
        }
        for (size_t row = 0; row < profileRows; ++row) {
            covered_[row] = double(std::count(ring[row].begin(), ring[row].end(), 1)) / ringColumns;
            off_[row] = medianOf(std::move(off[row]));
        }
        spacing_ = medianOf(std::move(spacing));
        bringToRim(rim, double(sheetThickness * scene.diagonal));
    }

    /// Height to which rings are whole, from the middle on; 0: none is.
    double top() const {
        size_t row = profileRows / 2;
        if (covered_[row] < wholeRing) return 0;
        while (row + 1 < profileRows && covered_[row + 1] >= wholeRing) ++row;
        return double(row) / profileRows * length_;
    }
    double length() const { return length_; }
    double spacing() const { return spacing_; }
    double tolerance() const { return near_; }
    double heightOf(const DVec3& p) const { return up_ * (surface_.height(p) - rim_); }
    double radiusAt(double height) const { return surface_.radiusAt(rim_ + up_ * height); }

    /// How far the mesh lies off the straight profile: the mean over three rows about a height.
    double offAt(double height) const {
        const int row = int(height / length_ * profileRows);
        double sum = 0;
        int rows = 0;
        for (int r = std::max(0, row - 1); r <= std::min(profileRows - 1, row + 1); ++r) {
            sum += off_[size_t(r)];
            ++rows;
        }
        return sum / std::max(1, rows);
    }
    /// A place of the outer side or of the inner one. What the rim is off by fades towards `end`.
    DVec3 at(double height, double angle, bool inner, double end) const {
        const DVec3 normal = surface_.normal(angle);
        const auto side = [&](double h) {
            return surface_.at(rim_ + up_ * h, angle) + (offAt(h) - (inner ? thickness_ : 0.0)) * normal;
        };
        const DVec3 middle = surface_.centre + rim_ * surface_.axis;
        const DVec3 out = glm::normalize(surface_.at(rim_, angle) - middle);
        const DVec3 rim = middle + (inner ? inner_ : outer_) * out;
        return side(height) + std::max(0.0, 1 - height / end) * (rim - side(0));
    }

private:
    /// Radii of the rim's two edges and the sheet's thickness, as far as photographs tell them.
    void bringToRim(const RimCircle& rim, double usual) {
        const double lean =
            std::sqrt(1 + surface_.slope * surface_.slope);  // along the radius, of a metre along the normal
        outer_ = rim.outer > 0 ? rim.outer : radiusAt(0) + offAt(0) * lean;
        thickness_ = usual;
        if (rim.inner > 0) {
            thickness_ = std::clamp((outer_ - rim.inner) / lean, usual * thinnestSheet, usual * thickestSheet);
            outer_ = rim.inner + thickness_ * lean;
        }
        inner_ = outer_ - thickness_ * lean;
    }

    const Scene& scene_;
    const RevolutionSurface& surface_;
    double rim_, up_, length_ = 0, near_ = 0, spacing_ = 0;
    double outer_ = 0, inner_ = 0, thickness_ = 0;  ///< radii of the rim's edges; along the normal
    std::array<double, profileRows> covered_{}, off_{};
};

}  // namespace

std::optional<SurfacePatch> wholeShade(const Scene& scene, size_t own, const RoundSheet& sheet, const RimCircle& rim,
                                       bool low) {
    const Profile profile(scene, own, sheet, rim, low);
    const double top = profile.top(), near = profile.tolerance();
    if (!(profile.length() > 0) || top < leastWhole * profile.length() || !(profile.spacing() > 0)) return {};
    SurfacePatch patch;
    const double end = top + underMesh * near;
    const int rows = std::max(2, int(std::ceil(end / profile.spacing()))),
              columns = std::max(12, int(std::ceil(2 * piD * std::max(profile.radiusAt(0), profile.radiusAt(end)) /
                                                   profile.spacing())));
    for (const bool inner : {false, true})
        for (int row = 0; row <= rows; ++row)
            for (int column = 0; column < columns; ++column)
                patch.positions.push_back(Vec3(profile.at(end * row / rows, 2 * piD * column / columns, inner, end)));
    const auto layer = uint32_t((rows + 1) * columns);
    const auto number = [&](int row, int column) { return uint32_t(row * columns + column % columns); };
    // Heights grow along the axis or against it, and with them the turn of the outer side's triangles.
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        if (low) patch.triangles.push_back({a, b, c});
        else patch.triangles.push_back({a, c, b});
    };
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const uint32_t a = number(row, column), b = number(row, column + 1), c = number(row + 1, column + 1),
                           d = number(row + 1, column);
            add(a, b, c);
            add(a, c, d);
            add(layer + a, layer + c, layer + b);
            add(layer + a, layer + d, layer + c);
        }
    for (int column = 0; column < columns; ++column) {  // the rim itself
        const uint32_t a = number(0, column), b = number(0, column + 1);
        add(a, layer + a, layer + b);
        add(a, layer + b, b);
    }
    patch.area = float(2 * piD * profile.radiusAt(end / 2) * end);
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& corners = scene.mesh.triangles[t];
        if (std::all_of(corners.begin(), corners.end(), [&](uint32_t v) {
                const DVec3 p(scene.mesh.positions[v]);
                const double height = profile.heightOf(p), distance = rim.surface.distance(p);
                return height > -overRim * near && height < top && distance > -inside * near &&
                       distance < outside * near;
            }))
            patch.replaced.push_back(t);
    }
    return patch;
}

}  // namespace relamp
