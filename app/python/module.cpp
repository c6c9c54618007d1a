// The module `relamp`: shots opened, solved, edited, rendered and exported from Python.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <nlohmann/json.hpp>

#include "base/is_there.h"
#include "base/json_fields.h"
#include "base/parallel.h"
#include "capture/own_axes.h"
#include "capture/photograph_reader.h"
#include "job.h"
#include "pipeline/shot_of.h"
#include "pipeline/texture_stage.h"
#include "references.h"
#include "relight/frame.h"
#include "relight/state_look.h"
#include "shot/export_scene.h"
#include "shot/shot_lock.h"

namespace py = pybind11;

namespace relamp::python {
namespace {

namespace fs = std::filesystem;

Json jsonOf(const py::object& value) {
    return parseJson(py::module_::import("json").attr("dumps")(value).cast<std::string>());
}

py::object objectOf(const Json& value) { return py::module_::import("json").attr("loads")(dumpJson(value)); }

/// An array over memory of `owner`, which lives as long as the array. Not to be written to.
template <class T>
py::array arrayOver(const std::vector<T>& values, std::vector<py::ssize_t> shape, const py::object& owner) {
    using Number = std::conditional_t<std::is_same_v<T, Triangle>, uint32_t, float>;
    static_assert(sizeof(T) % sizeof(Number) == 0);
    py::array_t<Number> array(std::move(shape), reinterpret_cast<const Number*>(values.data()), owner);
    array.attr("flags").attr("writeable") = false;
    return array;
}

/// A rendered frame with the names of its lights.
struct RenderedFrame {
    Frame frame;
    std::vector<std::string> lights;

    template <class T>
    static py::array layer(const py::object& self, const std::vector<T>& values) {
        const Frame& f = self.cast<const RenderedFrame&>().frame;
        std::vector<py::ssize_t> shape{f.height, f.width};
        if (sizeof(T) > sizeof(float)) shape.push_back(py::ssize_t(sizeof(T) / sizeof(float)));
        return arrayOver(values, std::move(shape), self);
    }
};

/// An opened shot; its scene is built when a frame asks for it.
class OpenShot {
public:
    OpenShot(const fs::path& folder, const py::object& tell) {
        Progress progress;
        runJob(tell, progress, [&] { shot_ = openShot(folder, false, progress); });
    }

    const Shot& shot() const { return shot_; }
    py::object look() const { return objectOf(lookToJson(shot_.look, shot_.capture.origin)); }
    void setLook(const py::object& look) { shot_.look = lookOf(look); }

    RenderedFrame render(int view, const py::object& pose, const py::object& look, const py::object& state, int samples,
                         uint64_t seed, bool denoise, int threads, const py::object& tell) {
        if (view < 0 || size_t(view) >= shot_.capture.views.size())
            throw Error("camera: is {}, the capture has {} views, from 0", view, shot_.capture.views.size());
        if (samples < 1 || samples > 4096) throw Error("samples: is {}, expected 1 to 4096", samples);
        Camera camera = shot_.capture.views[size_t(view)].camera;
        if (!pose.is_none()) camera.worldFromCamera = poseOf(pose);
        const Look edits = inStateNamed(look.is_none() ? shot_.look : lookOf(look), state);
        RenderedFrame result;
        Progress progress;
        runJob(tell, progress, [&] {
            const ThreadLimit limit(threads);
            const RelitScene relit = applyLook(scene(progress), shot_.estimate, edits, progress);
            FrameOptions options;
            options.samplesPerPixel = samples;
            options.seed = seed;
            options.denoise = denoise && samples > 1;
            result.frame = renderFrame(relit, camera, options, progress);
            for (const RelitEmitter& emitter : relit.emitters) result.lights.push_back(emitter.name);
        });
        return result;
    }

    void exportTo(const fs::path& folder, const py::object& look, const py::object& state, bool overwrite,
                  const py::object& tell) {
        const Look edits = inStateNamed(look.is_none() ? shot_.look : lookOf(look), state);
        Progress progress;
        runJob(tell, progress, [&] {
            InputFiles inputs = shotFiles(shot_, progress);
            for (const fs::path& file : filesOf(edits)) inputs.add(file);
            exportScene(shot_, applyLook(scene(progress), shot_.estimate, edits, progress), folder, overwrite, inputs);
        });
    }

    void save(const py::object& folder, bool overwrite) {
        const bool here = folder.is_none();
        const fs::path target = here ? shot_.folder : folder.cast<fs::path>();
        saveShot(shot_, shot_.capture.mesh, target, overwrite || here);
        shot_.folder = target;
    }

private:
    Shot shot_;
    std::optional<Scene> scene_;

    const Scene& scene(Progress& progress) {
        if (!scene_) scene_ = buildScene(shot_.capture.mesh, progress, ownAxes(shot_.capture));
        return *scene_;
    }
    /// Relative file names count from the current folder.
    Look lookOf(const py::object& look) const {
        return lookFromJson(jsonOf(look), fs::current_path(), shot_.capture.origin);
    }
    /// The light of a lighting state of the photographs, by its name; None: lights as bright as they get.
    Look inStateNamed(Look look, const py::object& state) const {
        if (state.is_none()) return look;
        const std::string name = state.cast<std::string>();
        for (size_t s = 0; s < shot_.estimate.states.size(); ++s)
            if (shot_.estimate.states[s].name == name) return inState(std::move(look), shot_.estimate, s);
        throw Error("state: no lighting state of the photographs is called {}", name);
    }
    DMat4 poseOf(const py::object& pose) const {
        const auto rows = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(pose);
        if (!rows || rows.ndim() != 2 || rows.shape(0) != 4 || rows.shape(1) != 4)
            throw Error("pose: expected 4 x 4 numbers");
        DMat4 matrix;
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) {
                matrix[c][r] = rows.at(r, c);
                if (!std::isfinite(matrix[c][r])) throw Error("pose[{}][{}]: is no number", r, c);
            }
        matrix[3] -= glm::dvec4(shot_.capture.origin, 0);
        return matrix;
    }
};

OpenShot solve(const fs::path& capture, const fs::path& output, const std::string& quality, const std::string& mode,
               const py::object& texture, const py::dict& states, const py::dict& environments, const py::dict& files,
               const py::dict& gauge, const py::dict& references, double timeBudget, uint64_t seed, int threads,
               bool overwrite, const py::object& tell) {
    PipelineOptions options;
    CaptureFix& fix = options.load.fix;
    takeFiles(files, fix);
    // In their order: of patterns the last that matches counts.
    for (const auto& [name, pattern] : states)
        fix.states.push_back({name.cast<std::string>(), pattern.cast<std::string>()});
    for (const auto& [name, environment] : environments)
        fix.environments.push_back({name.cast<std::string>(), environment.cast<std::string>()});
    options.solve = solveOptionsFor(quality);
    options.solve.seed = seed;
    takeGauge(gauge, options.solve.gauge);
    takeReferences(references, options);
    if (mode == "distant-only") options.solve.nearField = false;
    else if (mode != "near-field") throw Error("mode: is \"{}\", expected near-field or distant-only", mode);
    if (!texture.is_none()) {
        const int side = texture.cast<int>();
        if (side != 0 && (side < leastTextureSide || side > mostTextureSide))
            throw Error("texture: is {}, expected 0 or {} to {} texels", side, leastTextureSide, mostTextureSide);
        options.texture = side;
    }
    if (isThere(output) && !overwrite) throw Error("{}: exists already", output.string());
    Progress progress;
    progress.setBudget(timeBudget);
    runJob(tell, progress, [&] {
        const ThreadLimit limit(threads);
        checkShotCanBeWritten(output, captureFiles(capture, fix, progress));
        const ShotLock lock = ShotLock::take(output);
        if (!lock.owner().empty()) throw Error("{}: is open elsewhere ({})", output.string(), lock.owner());
        PipelineResult r = runPipeline(capture, options, progress);
        ShotSource source = sourceOf(r, capture, fix, quality, seed);
        source.resources = {progress.seconds(), peakMib(), threads > 0 ? threads : availableThreads()};
        saveShot(shotOf(std::move(r.estimate), source), r.scene->mesh, output, overwrite);
    });
    return OpenShot(output, py::none());
}

void bindFrame(py::module_& m) {
    const auto frameOf = [](const py::object& self) -> const Frame& { return self.cast<const RenderedFrame&>().frame; };
    py::class_<RenderedFrame> frame(m, "Frame",
                                    "A rendered frame. Arrays are read-only views of its memory, rows from the top, "
                                    "linear Rec.709 in the unit of the photographs.");
    const auto add = [&](const char* name, auto layer, const char* about) {
        frame.def_property_readonly(
            name, [=](const py::object& self) { return RenderedFrame::layer(self, frameOf(self).*layer); }, about);
    };
    add("beauty", &Frame::beauty, "Height x width x 3.");
    add("alpha", &Frame::alpha, "Height x width: 1 where a surface is.");
    add("world", &Frame::world, "Height x width x 3: what the environment gives, and itself.");
    add("albedo", &Frame::albedo, "Height x width x 3: matte weight.");
    add("normal", &Frame::normal, "Height x width x 3: of the pixel's centre, world.");
    add("position", &Frame::position, "Height x width x 3: metres from the capture's origin.");
    add("depth", &Frame::depth, "Height x width: along the camera's axis, metres; 1e30 where nothing is.");
    frame.def_property_readonly(
        "lights",
        [](const py::object& self) {
            const auto& f = self.cast<const RenderedFrame&>();
            py::dict lights;
            for (size_t e = 0; e < f.lights.size(); ++e)
                lights[py::str(f.lights[e])] = RenderedFrame::layer(self, f.frame.byEmitter[e]);
            return lights;
        },
        "By name, height x width x 3: what each light gives, and itself. With `world` they add up to `beauty`.");
}

void bindShot(py::module_& m) {
    using Array = py::array;
    const auto shotOfObject = [](const py::object& self) -> const Shot& { return self.cast<const OpenShot&>().shot(); };
    const auto vectors = [=](const py::object& self, const auto& values) -> Array {
        return arrayOver(values, {py::ssize_t(values.size()), 3}, self);
    };
    py::class_<OpenShot>(m, "Shot", "What a solve found, with the edits of a look.")
        .def_property_readonly(
            "folder", [=](const py::object& self) { return shotOfObject(self).folder; }, "Where it lies.")
        .def_property_readonly(
            "info", [=](const py::object& self) { return objectOf(shotInfo(shotOfObject(self))); },
            "shot.json without its look, as `relamp info --json` prints it (docs/interface.md 2).")
        .def_property("look", &OpenShot::look, &OpenShot::setLook,
                      "The edits document (docs/interface.md 3), a copy; assign to change it.")
        .def_property_readonly(
            "views",
            [=](const py::object& self) {
                py::list names;
                for (const View& view : shotOfObject(self).capture.views) names.append(view.name);
                return names;
            },
            "Names of the capture's photographs; their number is a camera.")
        .def_property_readonly(
            "origin",
            [=](const py::object& self) {
                const DVec3& o = shotOfObject(self).capture.origin;
                return py::make_tuple(o.x, o.y, o.z);
            },
            "What positions count from, metres; 0 unless the capture lies far from its own origin.")
        .def_property_readonly(
            "positions",
            [=](const py::object& self) { return vectors(self, shotOfObject(self).capture.mesh.positions); },
            "Vertices x 3, metres, Z up.")
        .def_property_readonly(
            "normals", [=](const py::object& self) { return vectors(self, shotOfObject(self).capture.mesh.normals); },
            "Vertices x 3.")
        .def_property_readonly(
            "triangles",
            [=](const py::object& self) { return vectors(self, shotOfObject(self).capture.mesh.triangles); },
            "Triangles x 3, numbers of vertices.")
        .def_property_readonly(
            "albedo",
            [=](const py::object& self) { return vectors(self, shotOfObject(self).estimate.reflectance.weight.at(0)); },
            "Vertices x 3: matte weight.")
        .def_property_readonly(
            "confidence",
            [=](const py::object& self) {
                const auto& values = shotOfObject(self).estimate.reflectance.confidence;
                return arrayOver(values, {py::ssize_t(values.size())}, self);
            },
            "Of each vertex' albedo, 0 to 1.")
        .def("render", &OpenShot::render, py::arg("camera") = 0, py::kw_only(), py::arg("pose") = py::none(),
             py::arg("look") = py::none(), py::arg("state") = py::none(), py::arg("samples") = 8, py::arg("seed") = 1,
             py::arg("denoise") = true, py::arg("threads") = 0, py::arg("progress") = py::none(),
             "A frame through the lens of view `camera`; `pose` (worldFromCamera, 4 x 4, looks along -Z) puts it "
             "elsewhere. `look`: a document in place of the shot's. `state`: the name of a lighting state, whose light "
             "the look edits.")
        .def("export", &OpenShot::exportTo, py::arg("folder"), py::kw_only(), py::arg("look") = py::none(),
             py::arg("state") = py::none(), py::arg("overwrite") = false, py::arg("progress") = py::none(),
             "Writes lights, surfaces, cameras and environment for other programs (docs/interface.md 6).")
        .def("save", &OpenShot::save, py::arg("folder") = py::none(), py::kw_only(), py::arg("overwrite") = false,
             "Writes the shot with its look, where it lies or elsewhere.");
}

}  // namespace
}  // namespace relamp::python

PYBIND11_MODULE(relamp, m) {
    using namespace relamp;
    m.doc() = "Relighting from photographs: solve a capture, edit its lights, render frames as NumPy arrays.";
    m.attr("__version__") = RELAMP_VERSION;
    static const py::exception<Error> error(m, "Error", PyExc_RuntimeError);
    static const py::exception<Cancelled> cancelled(m, "Cancelled", PyExc_RuntimeError);
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(thrown);
        } catch (const Cancelled&) { PyErr_SetString(cancelled.ptr(), "stopped"); } catch (const Error& e) {
            PyErr_SetString(error.ptr(), e.what());
        }
    });
    python::bindFrame(m);
    python::bindShot(m);
    m.def(
        "open",
        [](const std::filesystem::path& folder, const py::object& tell) { return python::OpenShot(folder, tell); },
        py::arg("shot"), py::kw_only(), py::arg("progress") = py::none(), "Opens NAME.relamp.");
    m.def(
        "solve", &python::solve, py::arg("capture"), py::arg("output"), py::kw_only(), py::arg("quality") = "standard",
        py::arg("mode") = "near-field", py::arg("texture") = py::none(), py::arg("states") = py::dict(),
        py::arg("state_environments") = py::dict(), py::arg("files") = py::dict(), py::arg("gauge") = py::dict(),
        py::arg("references") = py::dict(), py::arg("time_budget") = 0.0, py::arg("seed") = 1, py::arg("threads") = 0,
        py::arg("overwrite") = false, py::arg("progress") = py::none(),
        "Solves a capture into the shot `output` and opens it. `progress(label, fraction)` is called about ten times "
        "a second; where it returns False the solve stops with relamp.Cancelled. `states`: lighting states by name, "
        "with patterns of their photographs; `state_environments`: own, none, shared, or the state whose it is. "
        "`files`: how the capture is read (colmap, images, mesh, up, mesh_up, scale, mesh_scale, flip_cameras, mirror, "
        "mesh_mirror). `gauge`: what fixes the brightness scale (albedo; white_patch; emitter and radiance). "
        "`references`: light_probes, mirror_balls, greys, charts.");
}
