#include "pipeline/mend_mesh.h"

#include "base/log.h"
#include "base/sort_unique.h"
#include "base/statistics.h"
#include "clusters/emitter_mend.h"
#include "clusters/shining_sides.h"
#include "pipeline/complete_lights.h"
#include "pipeline/emitter_backs.h"
#include "pipeline/flat_emitters.h"
#include "pipeline/light_obstacles.h"
#include "pipeline/open_shades.h"
#include "pipeline/sharpen_creases.h"
#include "pipeline/stand_mend.h"
#include "pipeline/working_mesh.h"
#include "radiance/back_sides.h"
#include "radiance/crossed_sheets.h"
#include "radiance/cut_surfaces.h"
#include "radiance/free_space.h"
#include "radiance/mirror_spheres.h"
#include "radiance/missing_parts.h"
#include "radiance/slab_sides.h"
#include "radiance/whole_shade.h"
#include "solve/registration/contour_fit.h"
#include "solve/registration/rim_circle.h"
#include "solve/registration/round_rim.h"
#include "transport/unlit_skirts.h"

namespace relamp {
namespace {

class MeshMender {
public:
    MeshMender(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
               Progress& progress)
        : options_(options),
          capture_(capture),
          prepared_(prepared),
          meter_(meter),
          progress_(progress),
          file_(withoutProxies(capture.mesh, capture.proxies.size())),
          proxies_(capture.proxies) {}

    void partSheets() {
        const CrossedSheets found = crossedSheets(*prepared_.scene, capture_, *prepared_.samples, verticesOfLights());
        if (found.moved.empty()) return;
        mend_.moved.insert(mend_.moved.end(), found.moved.begin(), found.moved.end());
        apply({});
        say(
            fmt::format("two sides of thin sheets had passed through one another ({} vertices, by up to {:.1f} mm): "
                        "apart again",
                        found.crossed, 1000 * found.deepest));
    }

    /// Whether there were any.
    bool takeSkirtsOff() {
        // What mirrors the background is not the background.
        std::vector<uint8_t> surely = verticesOfLights();
        for (const MirrorSphere& sphere : mirrorSpheres(*prepared_.scene, *prepared_.samples, surely))
            for (const uint32_t v : sphere.vertices) surely[v] = 1;
        const std::vector<uint32_t> past = freeSpaceTriangles(*prepared_.scene, capture_, *prepared_.samples, surely,
                                                              progress_),
                                    unlit = unlitSkirts(*prepared_.scene, *prepared_.samples, prepared_.clusters,
                                                        surely, progress_);
        std::set_union(past.begin(), past.end(), unlit.begin(), unlit.end(), std::back_inserter(mend_.removed));
        if (mend_.removed.empty()) return false;
        const RadianceSamples before = *prepared_.samples;
        apply({});
        say(fmt::format("{} triangles stand where photographs show the background past them: left out",
                        mend_.removed.size()));
        squareSlabs(before);
        return true;
    }

    /// Edges of tables and boards, and the sides below them, which skirts had hidden. `before`: with the skirts.
    void squareSlabs(const RadianceSamples& before) {
        SlabSides found = slabSides(*prepared_.scene, capture_, before, verticesOfLights());
        if (found.edges == 0) return;
        add(found.removed, mend_.removed);
        mend_.moved.insert(mend_.moved.end(), found.moved.begin(), found.moved.end());
        addPatch(found.sides);
        apply({});
        say(fmt::format(
            "{} straight edges of flat surfaces were brought to where photographs show them, with {:.0f} cm2 "
            "of sides down to {:.1f} cm below them",
            found.edges, 1e4f * found.sides.area, 100 * found.depth));
    }

    void completeSurfaces() {
        sheets_ = roundSheets(*prepared_.scene, capture_, *prepared_.samples, progress_);
        float area = 0;
        std::vector<uint32_t> replaced;
        for (const RoundSheet& sheet : sheets_) {
            completed_.push_back({mend_.addedPositions.size(), sheet.missing.positions.size()});
            addPatch(sheet.missing);
            replaced.insert(replaced.end(), sheet.missing.replaced.begin(), sheet.missing.replaced.end());
            area += sheet.missing.area;
        }
        if (!(area > 0)) return;
        sortUnique(replaced);
        add(replaced, mend_.removed);
        apply({});
        say(fmt::format("photographs show {:.0f} cm2 of round surfaces that the mesh lacks: added", 1e4f * area));
    }

    /// Edges of boxes, plinths and walls, which the mesh rounds. `shape`: the mesh before outlines were moved.
    void sharpenCreases(const std::vector<Vec3>& shape) {
        const Mesh& mesh = prepared_.scene->mesh;
        SharpenOptions sharpen{file_.vertexCount(), verticesOfLights(), verticesOfLights(), darkness()};
        std::fill(sharpen.leftOut.begin() + std::ptrdiff_t(file_.vertexCount()), sharpen.leftOut.end(), uint8_t(1));
        for (const MeshMend::MovedVertex& m : mend_.moved) sharpen.leftOut[m.vertex] = 1;
        const SharpenedMesh sharp = sharpenedCreases(capture_, *prepared_.scene, shape, sharpen, progress_);
        if (sharp.empty()) return;
        for (uint32_t v = 0; v < file_.vertexCount(); ++v) {
            if (!sharpen.leftOut[v] && sharp.positions[v] != mesh.positions[v])
                mend_.moved.push_back({v, sharp.positions[v]});
            if (sharp.sides[v] != Vec3(0)) mend_.turned.push_back({v, sharp.sides[v]});
        }
        apply({});
        say(fmt::format("rounded creases are sharp where two flat sides meet ({} vertices)", mend_.turned.size()));
    }

    /// Balls that mirror: a normal that is a degree off shows another part of the sky.
    void roundMirrors() {
        bool any = false;
        for (const MirrorSphere& ball : mirrorSpheres(*prepared_.scene, *prepared_.samples, verticesOfLights())) {
            const RoundedSphere round = roundedSphere(ball, capture_.mesh);
            if (round.moved.empty()) continue;
            for (const MeshMend::MovedVertex& m : round.moved)
                if (m.vertex < file_.vertexCount()) mend_.moved.push_back(m);
            for (const MeshMend::TurnedVertex& t : round.turned)
                if (t.vertex < file_.vertexCount()) mend_.turned.push_back(t);
            say(fmt::format(
                "a ball of {:.1f} mm radius mirrors its environment: {} vertices were brought onto it, which "
                "lay {:.2f} mm beside it",
                1000 * ball.radius, round.moved.size(), 1000 * ball.off));
            any = true;
        }
        if (any) apply({});
    }

    /// `inexact`: the mesh is known to be off somewhere.
    void shapeEmitters(bool inexact) {
        meter_.begin(Stage::emitters);
        EmitterMend found = mendEmitters(*prepared_.scene, capture_, *prepared_.samples, prepared_.clusters);
        if (inexact) liftFronts(*prepared_.scene, capture_, *prepared_.samples, prepared_.clusters, found);
        if (!found.needed()) return;
        balls_ = found.balls;
        placesInFile(found.bodies);
        add(found.removed, mend_.removed);
        addStands(heldBalls(found), mend_, true, found.words);
        const MeshMend without = mend_;
        const auto shape = [&] {
            mend_ = without;
            for (EmitterReplacement& r : found.bodies) addBody(r);
            for (const EmitterMove& m : found.moves) {
                mend_.moved.insert(mend_.moved.end(), m.vertices.begin(), m.vertices.end());
                mend_.shining.insert(mend_.shining.end(), m.shining.begin(), m.shining.end());
            }
            std::sort(mend_.shining.begin(), mend_.shining.end());
            apply(found.balls);
        };
        shape();
        if (findDarkSides(found.bodies)) shape();
        const auto worse = [&](const EmitterMove& m) {
            return overlapAfter(m, *prepared_.scene, capture_, *prepared_.samples, prepared_.clusters) < m.overlap;
        };
        const size_t tried = found.moves.size() + found.bodies.size();
        std::erase_if(found.moves, worse);
        std::erase_if(found.bodies, [&](const EmitterReplacement& r) { return worse(r.was); });
        if (const size_t kept = found.moves.size() + found.bodies.size(); kept < tried) {
            logInfo("moving the surfaces of {} of {} lights does not bring them nearer to the photographs: taken back",
                    tried - kept, tried);
            shape();
        }
        if (opens(openBags, found.bodies)) shape();
        if (opens(openShadeEnds, found.bodies)) shape();
        // Without the bodies: the place of one may have taken its post.
        if (addStands(heldBodies(found), without, false, found.words)) apply(found.balls);
        openShades(found);
        for (const std::string& words : found.words) say(words);
        for (const EmitterReplacement& r : found.bodies)
            say(r.was.words + (r.open ? "; open at its ends, it shines to both sides" : ""));
        for (const EmitterMove& m : found.moves) say(m.words);
    }

    /// Posts below lights, of the mesh as it was after `before`; whether there are any.
    bool addStands(const std::vector<HeldLight>& lights, const MeshMend& before, bool sleeves,
                   std::vector<std::string>& words) {
        const MendedStands stands =
            mendStands(file_, before, lights, sleeves, capture_, *prepared_.scene, darkness(), progress_);
        words.insert(words.end(), stands.words.begin(), stands.words.end());
        mend_.removed.insert(mend_.removed.end(), stands.replaced.begin(), stands.replaced.end());
        sortUnique(mend_.removed);
        for (const SurfacePatch& stand : stands.surfaces) addPatch(stand);
        return !stands.surfaces.empty();
    }

    void placesInFile(std::vector<EmitterReplacement>& bodies) const {
        for (EmitterReplacement& r : bodies)
            for (EmitterReplacement::Place* place : {&r.place, &r.whole}) place->removed = inFile(place->removed);
    }

    /// Whether `open` (openBags, openShadeEnds) changes any of the bodies.
    template <class Open>
    bool opens(const Open& open, std::vector<EmitterReplacement>& bodies) const {
        return open(*prepared_.scene, *prepared_.samples, prepared_.clusters, options_.solve, bodies, progress_);
    }

    /// Skins over the openings of shades: light passes them, and photographs see through them what lies behind.
    void openShades(EmitterMend& found) {
        const std::vector<uint32_t> obstacles = falseObstacles(
            *prepared_.scene, *prepared_.samples, prepared_.clusters,
            obstacleSuspects(*prepared_.scene, *prepared_.samples, prepared_.clusters, file_.vertexCount()),
            options_.solve, progress_);
        if (obstacles.empty()) return;
        const std::vector<uint8_t> isLight = verticesOf(*prepared_.scene, {&prepared_.clusters.emitters});
        std::vector<uint32_t> filling = obstacles;
        // Not of all sheets: others may take the wall of a shade for what fills them.
        for (const RoundSheet* shade : sheetsAbout(sheets_, found.balls))
            filling = withFilling(*shade, *prepared_.scene, isLight, filling);
        const SeenBehind behind = seenBehind(*prepared_.scene, capture_, *prepared_.samples, filling);
        logInfo("behind what hides a light lie backs of surfaces in {:.0f} % of the pixels, fronts in {:.0f} %",
                100 * behind.backs, 100 * behind.fronts);
        constexpr float mostlyBacks = 0.3f, closed = 0.75f;
        if (behind.backs > mostlyBacks && behind.backs + behind.fronts > closed) {
            std::vector<LightBall> lights;
            for (const ProxyLight& ball : found.balls) lights.push_back({Vec3(ball.centre), ball.radius});
            add(filling, mend_.removed);
            apply(found.balls);
            std::vector<uint32_t> without;
            const std::vector<SurfacePatch> whole = wholeShades(found, without);
            addPatch(backSides(*prepared_.scene, capture_, *prepared_.samples, without, lights));
            add(without, mend_.removed);
            for (const SurfacePatch& shade : whole) addPatch(shade);
            if (whole.empty()) {
                apply(found.balls);
                evenRims(found.balls);
            }
            found.words.push_back(
                fmt::format("{} triangles close the opening of a shade over a light: taken away, and the shade has an "
                            "inner side",
                            filling.size()));
        } else {
            add(obstacles, mend_.shadowless);
            found.words.push_back(
                fmt::format("{} triangles beside a light hide it though photographs are explained better without their "
                            "shadow: light passes them",
                            obstacles.size()));
        }
        apply(found.balls);
    }

    /// Shades about the balls as even sheets to the circles that photographs show; what they replace joins `without`.
    std::vector<SurfacePatch> wholeShades(EmitterMend& found, std::vector<uint32_t>& without) {
        std::vector<SurfacePatch> whole;
        std::vector<const RoundSheet*> done;
        for (const ProxyLight& ball : found.balls) {
            const RoundSheet* shade = sheetAbout(sheets_, ball);
            if (!shade || std::count(done.begin(), done.end(), shade)) continue;
            done.push_back(shade);
            const bool low = opensLow(*shade, ball);
            const std::optional<double> height =
                rimHeight(capture_, *prepared_.scene, shade->surface, low ? shade->low : shade->high, darkness());
            std::optional<SurfacePatch> sheet;
            if (height)
                sheet = wholeShade(*prepared_.scene, file_.vertexCount(), *shade, rimOf(*shade, *height, low), low);
            if (!sheet) continue;
            without.insert(without.end(), sheet->replaced.begin(), sheet->replaced.end());
            // What completed it before goes with the rest.
            const auto [first, count] = completed_[size_t(shade - sheets_.data())];
            std::erase_if(mend_.added, [&](const Triangle& t) { return t[0] >= first && t[0] < first + count; });
            found.words.push_back(
                "a shade is one even sheet from its rim on, in place of the shreds that opening it leaves");
            whole.push_back(std::move(*sheet));
        }
        sortUnique(without);
        return whole;
    }

    /// The rim at a height, as photographs show it or as the mesh has it.
    RimCircle rimOf(const RoundSheet& shade, double height, bool low) const {
        const double radius = shade.surface.radiusAt(height);
        const RimCircle start{shade.surface, height, radius, radius};
        if (const auto fitted = fitRimCircle(capture_, *prepared_.scene, start, low, darkness())) return *fitted;
        return {shade.surface, height, 0, 0};
    }

    /// The light stands in the opening.
    static bool opensLow(const RoundSheet& shade, const ProxyLight& ball) {
        const double at = shade.surface.height(ball.centre);
        return at - shade.low < shade.high - at;
    }

    /// What was taken away leaves shades with jagged ends: these are brought to the circle that photographs show.
    void evenRims(const std::vector<ProxyLight>& balls) {
        const size_t own = file_.vertexCount() + mend_.addedPositions.size();  // those of the balls follow
        for (const ProxyLight& ball : balls) {
            const RoundSheet* shade = sheetAbout(sheets_, ball);
            if (!shade) continue;
            const bool low = opensLow(*shade, ball);
            const std::optional<double> height =
                rimHeight(capture_, *prepared_.scene, shade->surface, low ? shade->low : shade->high, darkness());
            if (!height) continue;
            const std::vector<MeshMend::MovedVertex> rim = evenRim(*prepared_.scene, own, shade->surface, *height, low);
            logInfo("{} vertices of a shade's rim are brought to the circle that photographs show", rim.size());
            mend_.moved.insert(mend_.moved.end(), rim.begin(), rim.end());
        }
    }

    /// Lights of which the photographs' frames cut a part off.
    void completeLights() {
        std::vector<EmitterReplacement> found = completedLights(*prepared_.scene, capture_, *prepared_.samples,
                                                                prepared_.clusters, options_.solve, progress_);
        if (found.empty()) return;
        placesInFile(found);
        const MeshMend without = mend_;
        const auto shape = [&] {
            mend_ = without;
            for (EmitterReplacement& r : found) addBody(r);
            std::sort(mend_.shining.begin(), mend_.shining.end());
            apply(balls_);
        };
        shape();
        if (findDarkSides(found)) shape();
        if (opens(openBags, found)) shape();
        for (const EmitterReplacement& r : found) say(r.was.words);
    }

    /// Floors and walls that the photographs' frames cut: light does not come in behind their rims.
    void continueSurfaces() {
        const std::vector<CutSurface> sides =
            cutSurfaces(*prepared_.scene, capture_, *prepared_.samples, verticesOfLights());
        if (sides.empty()) return;
        std::vector<uint32_t> replaced;  // of the mesh as it is now: all go at once
        for (const CutSurface& side : sides) {
            addPatch(side.continued());
            replaced.insert(replaced.end(), side.replaced.begin(), side.replaced.end());
        }
        add(replaced, mend_.removed);
        apply(balls_);
        for (const CutSurface& side : sides)
            say(fmt::format("photographs cut {} off: it goes on by {:.2f} m, {}", side.words(capture_.origin),
                            side.likely,
                            side.level ? "to where another surface ends" : "a likely length; nothing says how far"));
    }

    /// Handles, posts, ears: what the mesh has lost.
    void addMissingParts() {
        const MissingParts found =
            missingParts(*prepared_.scene, capture_, *prepared_.samples, verticesOfLights(), progress_);
        if (found.parts == 0) return;
        addPatch(found.surface);
        apply(balls_);
        say(fmt::format("photographs show {} thin {} that the mesh lacks ({:.0f} cm2): added", found.parts,
                        found.parts == 1 ? "part" : "parts", 1e4f * found.surface.area));
    }

    /// Skins that close lights where no photograph looks.
    void closeLights() {
        const std::vector<uint32_t> skins =
            shiningSkins(*prepared_.scene, *prepared_.samples, prepared_.clusters, options_.solve, progress_);
        if (skins.empty()) return;
        mend_.shining.insert(mend_.shining.end(), skins.begin(), skins.end());
        std::sort(mend_.shining.begin(), mend_.shining.end());
        letSidesShine(*prepared_.scene, skins, prepared_.clusters);
        say("a surface that no photographs show closes a light, and what they do show is explained better if it shines "
            "too: it does");
    }

    /// Sheets that shine to the side which the mesh has not.
    void openBacks() {
        const std::vector<uint32_t> sheets =
            shiningToBothSides(*prepared_.scene, *prepared_.samples, prepared_.clusters, options_.solve, progress_);
        mend_.bothSides.insert(mend_.bothSides.end(), sheets.begin(), sheets.end());
        sortUnique(mend_.bothSides);
        if (!sheets.empty())
            say("a light is a sheet without a back, and photographs are explained better if it shines to both sides: "
                "it does");
    }

    MeshMend result() && { return std::move(mend_); }

private:
    /// Sides of the bodies that photographs show dark; whether there is any.
    bool findDarkSides(std::vector<EmitterReplacement>& bodies) const {
        bool any = false;
        for (EmitterReplacement& r : bodies) {
            r.dark = darkSides(r, *prepared_.scene, capture_, *prepared_.samples);
            any |= std::count(r.dark.begin(), r.dark.end(), 1) > 0;
        }
        return any;
    }
    /// Triangles of the mesh as it is, by their numbers in the file; without those of a ball.
    std::vector<uint32_t> inFile(const std::vector<uint32_t>& present) const {
        const std::vector<uint32_t> numbers = trianglesLeft(mend_, file_.triangles.size());
        std::vector<uint32_t> found;
        for (const uint32_t t : present)
            if (t < numbers.size()) found.push_back(numbers[t]);
        return found;
    }
    void add(const std::vector<uint32_t>& present, std::vector<uint32_t>& list) const {
        const std::vector<uint32_t> found = inFile(present);
        list.insert(list.end(), found.begin(), found.end());
        sortUnique(list);
    }
    /// A straight body of light: all of its sides shine but those that photographs show dark.
    void addBody(EmitterReplacement& r) {
        const auto within = [&](uint32_t v) { return r.body.distance(DVec3(mend_.addedPositions[v])) < 2 * r.margin; };
        if (r.open)  // what was added to the mesh's shade would show in it
            std::erase_if(mend_.added, [&](const Triangle& t) { return std::ranges::all_of(t, within); });
        SurfacePatch surface;
        std::vector<uint32_t> ends = r.body.surface(surface.positions, surface.triangles, r.open);
        ends.push_back(uint32_t(surface.positions.size()));
        r.first = uint32_t(file_.vertexCount() + mend_.addedPositions.size());
        for (size_t side = 0; side + 1 < ends.size(); ++side)
            for (uint32_t v = ends[side]; v < ends[side + 1] && (r.dark.empty() || !r.dark[side]); ++v) {
                mend_.shining.push_back(r.first + v);
                if (r.open) mend_.bothSides.push_back(r.first + v);
            }
        addPatch(surface);
        addPatch({r.place.ground, r.place.groundTriangles, {}, 0});
        for (const MeshMend::MovedVertex& m : r.setBack)
            if (m.vertex < file_.vertexCount()) {
                mend_.moved.push_back(m);
                if (r.level != Vec3(0)) mend_.turned.push_back({m.vertex, r.level});
            }
        mend_.removed.insert(mend_.removed.end(), r.place.removed.begin(), r.place.removed.end());
        sortUnique(mend_.removed);
    }
    void addPatch(const SurfacePatch& patch) {
        const auto first = uint32_t(mend_.addedPositions.size());
        mend_.addedPositions.insert(mend_.addedPositions.end(), patch.positions.begin(), patch.positions.end());
        for (const auto& [a, b, c] : patch.triangles) mend_.added.push_back({first + a, first + b, first + c});
    }
    void apply(const std::vector<ProxyLight>& balls) {
        capture_.mesh = file_;
        capture_.proxies = proxies_;
        applyMend(mend_, capture_.mesh);
        capture_.proxies.insert(capture_.proxies.end(), balls.begin(), balls.end());
        addProxies(capture_.proxies, capture_.mesh);
        prepared_ = prepare(capture_, options_, meter_, progress_);
        letSidesShine(*prepared_.scene, mend_.shining, prepared_.clusters);
        letBacksShine(mend_.bothSides, prepared_.clusters);
    }
    std::vector<uint8_t> verticesOfLights() const {
        return verticesOf(*prepared_.scene, {&prepared_.clusters.emitters, &prepared_.clusters.candidates});
    }
    /// Radiance that counts as dark: a fiftieth of the median.
    float darkness() const {
        std::vector<float> brightness;
        for (const RadianceSample& s : prepared_.samples->samples) brightness.push_back(float(luminance(s.radiance)));
        return std::max(1e-20f, 0.02f * medianOf(std::move(brightness)));
    }
    void say(const std::string& words) {
        capture_.notes.push_back(words);
        logInfo("{}", words);
    }

    const PipelineOptions& options_;
    Capture& capture_;
    Prepared& prepared_;
    StageMeter& meter_;
    Progress& progress_;
    const Mesh file_;
    const std::vector<ProxyLight> proxies_;
    MeshMend mend_;
    std::vector<RoundSheet> sheets_;
    std::vector<ProxyLight> balls_;                     ///< of the emitters' own places
    std::vector<std::pair<size_t, size_t>> completed_;  ///< per sheet the first added vertex and how many
};

}  // namespace

std::vector<uint8_t> verticesOf(const Scene& scene, std::initializer_list<const std::vector<EmitterCluster>*> lists) {
    std::vector<uint8_t> marked(scene.mesh.vertexCount(), 0);
    for (const std::vector<EmitterCluster>* list : lists)
        for (const EmitterCluster& e : *list)
            for (const uint32_t v : e.vertices) marked[v] = 1;
    return marked;
}

MeshMend mendMesh(const PipelineOptions& options, Capture& capture, Prepared& prepared, const std::vector<Vec3>& shape,
                  StageMeter& meter, Progress& progress) {
    MeshMender mender(options, capture, prepared, meter, progress);
    mender.partSheets();
    const bool inexact = mender.takeSkirtsOff() || !shape.empty();
    if (inexact) mender.completeSurfaces();
    if (inexact) mender.sharpenCreases(shape);
    mender.roundMirrors();
    mender.shapeEmitters(inexact);
    if (inexact) mender.completeLights();
    if (inexact) mender.continueSurfaces();
    if (inexact) mender.addMissingParts();
    if (inexact) mender.closeLights();
    mender.openBacks();
    return std::move(mender).result();
}

}  // namespace relamp
