#include "radiance/cut_surfaces.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "radiance/edge_views.h"
#include "radiance/seen_past.h"

namespace relamp {
namespace {

constexpr double spacingsPerCell = 2;                  ///< vertices' spacings in a cell
constexpr size_t cellsAcross = 400;                    ///< across the mesh
constexpr double uprightTo = 0.5;                      ///< cosine between surfaces that meet at an angle
constexpr double leastDeep = 0.2;                      ///< of the surface's extent, that a line has of it
constexpr double cellsOnward = 6;                      ///< that a line must be able to go on by
constexpr double mostlyCut = 0.5;                      ///< of a side's lines
constexpr double leastLong = 0.2;                      ///< of a side
constexpr double beforeRim = 1.5;                      ///< cells: where what continues a surface begins
constexpr double likelyPart = 0.4;                     ///< of what is shown of a surface
constexpr double mostlyEnds = 0.5;                     ///< of a side's lines
constexpr double sameWay = 0.95;                       ///< cosine between directions of sides
constexpr double cornerCells = 10;                     ///< to where it meets another surface
constexpr float alikePast = 0.1f, differsPast = 0.3f;  ///< log ratios to what lies behind
constexpr float rimAlike = 0.25f;                      ///< log ratio to the surface's rim
constexpr double skirtHeight = 0.05;                   ///< of the diagonal: skirts leave a surface by so much

/// One flat surface with its seen vertices, along two directions in it.
class CutSearch {
public:
    CutSearch(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
              const std::vector<uint8_t>& isLight)
        : scene_(scene),
          capture_(capture),
          samples_(samples),
          isLight_(isLight),
          past_(scene, capture, samples),
          views_(scene, capture, past_.floor()) {}

    std::vector<CutSurface> result() {
        const std::vector<FlatSurface> surfaces = flatSurfaces(scene_, isLight_);
        std::vector<CutSurface> found;
        for (const FlatSurface& s : surfaces) {
            const auto other = std::find_if(surfaces.begin(), surfaces.end(), [&](const FlatSurface& o) {
                return std::abs(glm::dot(o.up, s.up)) < uprightTo;
            });
            if (other == surfaces.end()) continue;
            const DVec3 level = glm::normalize(glm::cross(s.up, other->up)), across = glm::cross(s.up, level);
            const std::vector<uint32_t> own = seenOn(s);
            if (own.empty()) continue;
            for (const DVec3& out : {across, -across, level, -level})
                if (std::optional<CutSurface> side = sideOf(s, own, out, surfaces)) found.push_back(std::move(*side));
        }
        for (CutSurface& side : found) {
            side.likely = likelyPart * side.shown;
            const double own = glm::dot(side.surface.point, side.out) + side.end;
            for (const ShownEnd& e : ends_) {
                if (glm::dot(e.out, side.out) < sameWay || e.at < own - cornerCells * side.cell) continue;
                side.likely = side.level ? std::min(side.likely, e.at - own) : e.at - own;
                side.level = true;
            }
        }
        std::erase_if(found, [](const CutSurface& side) { return side.level && side.likely < 2 * side.cell; });
        return found;
    }

private:
    std::vector<uint32_t> seenOn(const FlatSurface& s) const {
        std::vector<uint32_t> own;
        for (uint32_t v = 0; v < scene_.mesh.vertexCount(); ++v)
            if (scene_.referenced[v] && !isLight_[v] && samples_.countOf(v) > 0 && liesOn(scene_, s, v))
                own.push_back(v);
        return own;
    }

    std::optional<CutSurface> sideOf(const FlatSurface& s, const std::vector<uint32_t>& own, const DVec3& out,
                                     const std::vector<FlatSurface>& all) {
        CutSurface side;
        side.surface = s;
        side.out = out;
        side.along = glm::cross(out, s.up);
        std::vector<float> spacings;
        double low = 1e30, high = -1e30, near = 1e30, far = -1e30, square = 0;
        const auto at = [&](uint32_t v) { return glm::dot(DVec3(scene_.mesh.positions[v]) - s.point, side.along); };
        const auto beyond = [&](uint32_t v) { return glm::dot(DVec3(scene_.mesh.positions[v]) - s.point, out); };
        for (const uint32_t v : own) {
            spacings.push_back(scene_.vertexSpacing[v]);
            low = std::min(low, at(v));
            high = std::max(high, at(v));
            near = std::min(near, beyond(v));
            far = std::max(far, beyond(v));
            square += std::pow(s.off(DVec3(scene_.mesh.positions[v])), 2);
        }
        side.setBack = 1.5 * std::sqrt(square / double(own.size()));
        side.cell = std::max(spacingsPerCell * double(medianOf(std::move(spacings))),
                             double(scene_.diagonal) / double(cellsAcross));
        side.first = low;
        side.shown = far - near;
        struct Filled {
            double first = 1e30, last = -1e30;
        };
        std::vector<Filled> filled(size_t((high - low) / side.cell + 0.5) + 1);
        for (const uint32_t v : own) {
            Filled& line = filled[size_t((at(v) - low) / side.cell + 0.5)];
            line.first = std::min(line.first, beyond(v));
            line.last = std::max(line.last, beyond(v));
        }
        side.lines.resize(filled.size());
        std::vector<uint8_t> has(filled.size(), 0), ends(filled.size(), 0);
        parallelFor(filled.size(), 4, [&](size_t i) {
            has[i] = filled[i].last - filled[i].first > leastDeep * (far - near);
            if (has[i]) side.lines[i] = lineFrom(side, i, filled[i].last, ends[i]);
        });
        std::vector<double> nearest(filled.size(), 1e30);
        for (const uint32_t v : own) {
            const auto i = size_t((at(v) - low) / side.cell + 0.5);
            const double off =
                std::hypot(at(v) - low - double(i) * side.cell, beyond(v) - (filled[i].last - beforeRim * side.cell));
            if (off >= nearest[i]) continue;
            nearest[i] = off;
            side.lines[i].from = scene_.mesh.positions[v];
        }
        const auto lines = double(std::count(has.begin(), has.end(), 1));
        std::vector<float> cut, shown;
        for (size_t i = 0; i < filled.size(); ++i)
            if (side.lines[i].reach > 0) cut.push_back(float(side.lines[i].end));
            else if (ends[i]) shown.push_back(float(side.lines[i].end));
        logInfo("{}: of {:.0f} lines {} are cut by the frames, {} are shown to end", side.words(), lines, cut.size(),
                shown.size());
        if (double(shown.size()) > mostlyEnds * lines)
            ends_.push_back({out, glm::dot(s.point, out) + double(medianOf(std::move(shown)))});
        if (meshGoesOn(side)) return {};
        if (double(cut.size()) < mostlyCut * lines || double(cut.size()) * side.cell < leastLong * (high - low))
            return {};
        std::nth_element(cut.begin(), cut.begin() + ptrdiff_t(9 * cut.size() / 10), cut.end());
        side.end = double(cut[9 * cut.size() / 10]);
        closeGaps(side, ends);
        toCorners(side, all);
        findReplaced(side);
        return side;
    }

    /// The mesh has what no photograph shows there, as a scan does: on most of the lines it goes on in the plane.
    bool meshGoesOn(const CutSurface& side) const {
        std::vector<uint8_t> on(side.lines.size(), 0);
        for (uint32_t v = 0; v < scene_.mesh.vertexCount(); ++v) {
            if (!scene_.referenced[v] || !liesOn(scene_, side.surface, v)) continue;
            const DVec3 p = DVec3(scene_.mesh.positions[v]) - side.surface.point;
            const double line = std::round((glm::dot(p, side.along) - side.first) / side.cell);
            if (!(line >= 0) || line >= double(side.lines.size())) continue;
            const CutSurface::Line& l = side.lines[size_t(line)];
            if (l.reach > 0 && glm::dot(p, side.out) > l.end + cellsOnward * side.cell) on[size_t(line)] = 1;
        }
        const auto cut = std::count_if(side.lines.begin(), side.lines.end(), [](const auto& l) { return l.reach > 0; });
        return 2 * std::count(on.begin(), on.end(), 1) > cut;
    }

    /// One line from where the mesh ends; `ends`: photographs show that it does.
    CutSurface::Line lineFrom(const CutSurface& side, size_t line, double end, uint8_t& ends) const {
        const DVec3 foot = side.surface.point + (side.first + double(line) * side.cell) * side.along;
        const DVec3 rim = foot + (end - 2 * side.cell) * side.out, over = rim + 2 * side.cell * side.surface.up;
        const double least = cellsOnward * side.cell;
        const double most = freeAlong(over, side.out, side.shown + least) - 2 * side.cell;
        double reach = 0;
        while (reach + side.cell <= most && mayGoOn(foot + (end + reach + side.cell) * side.out, rim, side.cell))
            reach += side.cell;
        if (reach >= least) return {end, reach, Vec3(0)};
        ends = reach + side.cell <= most;
        return {end, 0, Vec3(0)};
    }

    /// Metres to the first surface that photographs show; those that none shows are skirts.
    double freeAlong(const DVec3& from, const DVec3& direction, double most) const {
        constexpr int layers = 8;
        const double past = double(scene_.tracer->surfaceOffset());
        double at = 0;
        for (int layer = 0; layer < layers; ++layer) {
            const Hit hit = scene_.tracer->closest({Vec3(from), Vec3(direction), float(at), float(most)});
            if (!hit) return most;
            const Triangle& corners = scene_.mesh.triangles[hit.triangle];
            if (std::any_of(corners.begin(), corners.end(), [&](uint32_t v) { return samples_.countOf(v) > 0; }))
                return double(hit.distance);
            at = double(hit.distance) + past;
        }
        return at;
    }

    /// No photograph shows what lies behind the place.
    bool mayGoOn(const DVec3& p, const DVec3& rim, double cell) const {
        int surface = 0, nothing = 0;
        for (size_t i = 0; i < capture_.views.size(); ++i) {
            const View& view = capture_.views[i];
            const std::optional<Rgb> shown = views_.shownAt(view, p);
            if (!shown) continue;
            const DVec3 eye = view.camera.position();
            if (views_.hidden(eye, p, 3 * cell)) continue;
            const double distance = glm::length(p - eye);
            const std::optional<float> off =
                past_.difference(i, Vec3((p - eye) / distance), float(distance + 4 * cell), *shown);
            const std::optional<Rgb> beside = views_.shownAt(view, rim);
            const bool alike = beside && logDistance(*shown, *beside, *beside, past_.floor()) < rimAlike;
            if (off ? *off < alikePast : !alike) ++nothing;
            else if (off ? *off > differsPast : alike) ++surface;
        }
        return nothing == 0 || surface > 2 * nothing;
    }

    /// Few lines between such as go on, at which nothing is shown to end, go on like those before them.
    static void closeGaps(CutSurface& side, const std::vector<uint8_t>& ends) {
        const auto lines = ptrdiff_t(side.lines.size());
        for (ptrdiff_t last = -1, i = 0; i < lines; ++i) {
            if (!(side.lines[size_t(i)].reach > 0)) continue;
            const bool none = std::count(ends.begin() + last + 1, ends.begin() + i, 1) == 0;
            for (ptrdiff_t k = last + 1; last >= 0 && none && double(i - last) < cornerCells && k < i; ++k)
                side.lines[size_t(k)] = likeLine(side, size_t(last), size_t(k));
            last = i;
        }
    }

    /// Where it meets another surface beside, it goes on to there.
    void toCorners(CutSurface& side, const std::vector<FlatSurface>& all) const {
        for (const FlatSurface& other : all) {
            const double slant = glm::dot(other.up, side.along);
            if (std::abs(glm::dot(other.up, side.surface.up)) > uprightTo || std::abs(slant) < 0.7) continue;
            const DVec3 level = side.surface.point + side.end * side.out;
            const double corner = -other.off(level) / slant;
            const auto line = ptrdiff_t(std::lround((corner - side.first) / side.cell));
            const auto open = [&](const CutSurface::Line& l) { return l.reach > 0; };
            const auto firstOpen = std::find_if(side.lines.begin(), side.lines.end(), open) - side.lines.begin();
            const auto lastOpen = ptrdiff_t(side.lines.size()) - 1 -
                                  (std::find_if(side.lines.rbegin(), side.lines.rend(), open) - side.lines.rbegin());
            if (line < firstOpen && double(firstOpen - line) < cornerCells) {
                if (line < 0) {
                    side.lines.insert(side.lines.begin(), size_t(-line), {});
                    side.first += double(line) * side.cell;
                }
                const auto shift = std::max<ptrdiff_t>(-line, 0);
                for (ptrdiff_t i = line + shift; i < firstOpen + shift; ++i)
                    side.lines[size_t(i)] = likeLine(side, size_t(firstOpen + shift), size_t(i));
            } else if (line > lastOpen && double(line - lastOpen) < cornerCells) {
                side.lines.resize(std::max(side.lines.size(), size_t(line) + 1));
                for (ptrdiff_t i = lastOpen + 1; i <= line; ++i)
                    side.lines[size_t(i)] = likeLine(side, size_t(lastOpen), size_t(i));
            }
        }
    }
    static CutSurface::Line likeLine(const CutSurface& side, size_t other, size_t line) {
        CutSurface::Line copy = side.lines[other];
        copy.from = Vec3(side.surface.point + (side.first + double(line) * side.cell) * side.along +
                         (copy.end - beforeRim * side.cell) * side.out);
        return copy;
    }

    void findReplaced(CutSurface& side) const {
        const Mesh& mesh = scene_.mesh;
        const auto stands = [&](uint32_t v) {
            const DVec3 p = DVec3(mesh.positions[v]) - side.surface.point;
            const double line = std::round((glm::dot(p, side.along) - side.first) / side.cell);
            if (isLight_[v] || samples_.countOf(v) > 0 || !(line >= 0) || line >= double(side.lines.size()))
                return false;
            const CutSurface::Line& l = side.lines[size_t(line)];
            const double off = glm::dot(p, side.surface.up), at = glm::dot(p, side.out);
            return l.reach > 0 && at > l.end - side.cell && at < l.end + l.reach &&
                   std::abs(off) < skirtHeight * double(scene_.diagonal);
        };
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
            if (std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), stands)) side.replaced.push_back(t);
    }

    /// A side at which photographs show that a surface ends.
    struct ShownEnd {
        DVec3 out{0};
        double at = 0;  ///< metres along it
    };

    const Scene& scene_;
    const Capture& capture_;
    const RadianceSamples& samples_;
    const std::vector<uint8_t>& isLight_;
    std::vector<ShownEnd> ends_;
    const SeenPast past_;
    const EdgeViews views_;
};

}  // namespace

SurfacePatch CutSurface::continued() const {
    SurfacePatch patch;
    patch.replaced = replaced;
    const int rows = std::max(3, int(std::ceil(likely / cell)));
    const DVec3 plane = surface.point - setBack * surface.up;
    uint32_t before = 0;
    bool open = false;
    for (size_t i = 0; i < lines.size(); ++i) {
        const bool was = open;
        open = lines[i].reach > 0;
        if (!open) continue;
        const auto now = uint32_t(patch.positions.size());
        const double rim = lines[i].end, from = rim - cell, to = std::clamp(end + likely, rim, rim + lines[i].reach);
        patch.positions.push_back(lines[i].from);
        for (int row = 0; row < rows; ++row)
            patch.positions.push_back(Vec3(plane + (first + double(i) * cell) * along +
                                           (from + double(row) / (rows - 1) * (to - from)) * out));
        // Lines of other lengths shear what joins their first rows.
        const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
            const std::vector<Vec3>& p = patch.positions;
            const bool turned = glm::dot(glm::cross(p[b] - p[a], p[c] - p[a]), Vec3(surface.up)) < 0;
            patch.triangles.push_back(turned ? Triangle{a, c, b} : Triangle{a, b, c});
        };
        for (uint32_t row = 0; was && row < uint32_t(rows); ++row) {
            add(before + row, now + row, now + row + 1);
            add(before + row, now + row + 1, before + row + 1);
        }
        if (was) patch.area += float(cell * (to - rim));
        before = now;
    }
    return patch;
}

std::string CutSurface::words(const DVec3& origin) const {
    const DVec3 p = surface.point + origin;
    return fmt::format("a flat surface at {:.2f} {:.2f} {:.2f}, towards {:.2f} {:.2f} {:.2f}", p.x, p.y, p.z, out.x,
                       out.y, out.z);
}

std::vector<CutSurface> cutSurfaces(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                    const std::vector<uint8_t>& isLight) {
    return CutSearch(scene, capture, samples, isLight).result();
}

}  // namespace relamp
