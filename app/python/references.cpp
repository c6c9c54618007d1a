// What Python tells of a capture's files and of its light, as dictionaries.
#include "references.h"

#include "pipeline/marked_reference.h"

namespace relamp::python {
namespace py = pybind11;
namespace {

/// A dictionary whose keys are asked for one by one; errors name it and the key.
class Told {
public:
    Told(py::handle dictionary, std::string name) : name_(std::move(name)) {
        if (!py::isinstance<py::dict>(dictionary)) throw Error("{}: expected a dictionary", name_);
        values_ = py::reinterpret_borrow<py::dict>(dictionary);
    }
    bool has(const char* key) const { return values_.contains(key) && !values_[key].is_none(); }
    template <class T>
    T get(const char* key, const char* expected) const {
        try {
            if (has(key)) return values_[key].cast<T>();
        } catch (const py::cast_error&) {}
        throw Error("{}: {}: expected {}", name_, key, expected);
    }
    Vec2 point(const char* key) const { return pointOf(has(key) ? py::object(values_[key]) : py::none(), key); }
    Vec2 pointOf(const py::object& value, const char* key) const {
        const std::vector<double> v = numbers(value, key, 2);
        return {v[0], v[1]};
    }
    std::vector<double> numbers(const py::object& value, const char* key, size_t count) const {
        std::vector<double> found;
        try {
            if (py::isinstance<py::sequence>(value))
                for (const py::handle number : value) found.push_back(number.cast<double>());
        } catch (const py::cast_error&) { found.clear(); }
        if (found.size() != count ||
            !std::all_of(found.begin(), found.end(), [](double v) { return std::isfinite(v); }))
            throw Error("{}: {}: expected {} numbers", name_, key, count);
        return found;
    }
    size_t view() const {
        const int view = get<int>("view", "a view's number, counted from 0");
        if (view < 0) throw Error("{}: view: is {}, expected 0 or more", name_, view);
        return size_t(view);
    }
    /// Throws Error for a key that is none of these.
    void only(std::initializer_list<std::string_view> keys) const {
        for (const auto& [key, value] : values_) {
            const auto name = py::str(key).cast<std::string>();
            if (std::find(keys.begin(), keys.end(), name) == keys.end()) throw Error("{}: {}: unknown", name_, name);
        }
    }
    /// A list or a tuple: anything else, texts too, would become one.
    py::list list(const char* key, const char* expected) const {
        const py::object found = value(key);
        if (!py::isinstance<py::list>(found) && !py::isinstance<py::tuple>(found))
            throw Error("{}: {}: expected {}", name_, key, expected);
        return py::list(found);
    }
    py::object value(const char* key) const { return has(key) ? py::object(values_[key]) : py::none(); }

private:
    py::dict values_;
    std::string name_;
};

Rgb albedoOf(const Told& told) {
    if (!told.has("albedo")) return MarkedReference().albedo;
    const py::object value = told.value("albedo");
    const std::vector<double> a = py::isinstance<py::sequence>(value)
                                      ? told.numbers(value, "albedo", 3)
                                      : std::vector<double>(3, told.get<double>("albedo", "one number or three"));
    const Rgb albedo(a[0], a[1], a[2]);
    if (!(std::min({albedo.x, albedo.y, albedo.z}) >= 0.005f && maxChannel(albedo) <= 1))
        throw Error("greys: albedo: expected 0.005 to 1");
    return albedo;
}

MarkedReference discOf(const Told& told, MarkedReference::Kind kind) {
    MarkedReference mark;
    mark.kind = kind;
    mark.view = told.view();
    if (kind == MarkedReference::Kind::mirrorBall && !told.has("at")) return mark;
    mark.points = {told.point("at")};
    mark.radius = told.get<float>("radius", "pixels");
    if (!(mark.radius >= 0)) throw Error("radius: is {}, expected 0 pixels or more", mark.radius);
    return mark;
}

MarkedReference chartOf(const Told& told) {
    MarkedReference mark;
    mark.kind = MarkedReference::Kind::chart;
    mark.view = told.view();
    for (const py::handle corner : told.list("corners", "four points: dark skin, bluish green, black, white"))
        mark.points.push_back(told.pointOf(py::reinterpret_borrow<py::object>(corner), "corners"));
    if (mark.points.size() != 4) throw Error("charts: corners: there are {}, expected 4", mark.points.size());
    return mark;
}

}  // namespace

void takeFiles(const py::dict& files, CaptureFix& fix) {
    const Told told(files, "files");
    told.only(
        {"colmap", "images", "mesh", "up", "mesh_up", "scale", "mesh_scale", "flip_cameras", "mirror", "mesh_mirror"});
    for (const auto& [key, place] : {std::pair{"colmap", &CaptureFix::colmap},
                                     {"images", &CaptureFix::images},
                                     {"mesh", &CaptureFix::mesh},
                                     {"up", &CaptureFix::up},
                                     {"mesh_up", &CaptureFix::meshUp},
                                     {"mirror", &CaptureFix::mirror},
                                     {"mesh_mirror", &CaptureFix::meshMirror}})
        if (told.has(key)) fix.*place = py::str(told.value(key)).cast<std::string>();
    if (told.has("scale")) fix.scale = told.get<double>("scale", "metres a unit is long");
    if (told.has("mesh_scale")) fix.meshScale = told.get<double>("mesh_scale", "units of the cameras");
    if (told.has("flip_cameras")) fix.flipCameras = told.get<bool>("flip_cameras", "True or False");
}

void takeGauge(const py::dict& gauge, GaugeChoice& choice) {
    const Told told(gauge, "gauge");
    told.only({"albedo", "white_patch", "emitter", "radiance"});
    if (told.has("albedo")) {
        choice.kind = GaugeChoice::Kind::albedo;
        choice.albedo = told.get<float>("albedo", "a number");
        if (!(choice.albedo >= 0.001f && choice.albedo <= 1)) throw Error("gauge: albedo: expected 0.001 to 1");
    } else if (told.has("white_patch")) {
        const std::vector<double> v = told.numbers(told.value("white_patch"), "white_patch", 3);
        if (!(v[0] >= 0 && v[0] < 1e6)) throw Error("gauge: white_patch: expected a view's number and a pixel");
        choice.kind = GaugeChoice::Kind::whitePatch;
        choice.view = int(v[0]);
        choice.pixel = {v[1], v[2]};
    } else if (told.has("emitter")) {
        choice.kind = GaugeChoice::Kind::emitter;
        choice.emitter = told.get<std::string>("emitter", "the id of a light");
        const std::vector<double> r = told.numbers(told.value("radiance"), "radiance", 3);
        choice.radiance = {r[0], r[1], r[2]};
        if (!(std::min({r[0], r[1], r[2]}) > 0)) throw Error("gauge: radiance: expected more than 0 in each channel");
    }
}

void takeReferences(const py::dict& references, PipelineOptions& options) {
    const Told told(references, "references");
    told.only({"light_probes", "mirror_balls", "greys", "charts"});
    const auto each = [&](const char* key, auto&& take) {
        if (!told.has(key)) return;
        size_t index = 0;
        for (const py::handle one : told.list(key, "a list")) take(one, fmt::format("{}[{}]", key, index++));
    };
    each("light_probes", [&](py::handle file, const std::string&) {
        options.probes.push_back(readLightProbe(py::str(file).cast<std::string>()));
    });
    each("mirror_balls", [&](py::handle ball, const std::string& name) {
        const Told one(ball, name);
        one.only({"view", "photograph", "at", "radius"});
        MarkedReference mark = discOf(one, MarkedReference::Kind::mirrorBall);
        if (one.has("photograph")) mark.photograph = py::str(one.value("photograph")).cast<std::string>();
        takeReference(mark, options);
    });
    each("greys", [&](py::handle grey, const std::string& name) {
        const Told one(grey, name);
        one.only({"view", "at", "radius", "albedo"});
        MarkedReference mark = discOf(one, MarkedReference::Kind::grey);
        mark.albedo = albedoOf(one);
        takeReference(mark, options);
    });
    each("charts", [&](py::handle chart, const std::string& name) {
        const Told one(chart, name);
        one.only({"view", "corners"});
        withContext(name, [&] { takeReference(chartOf(one), options); });
    });
}

}  // namespace relamp::python
