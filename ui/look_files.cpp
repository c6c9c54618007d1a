#include "look_files.h"

#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "editor_impl.h"
#include "relight/shaping_files.h"
#include "settings.h"

namespace relamp::ui {
namespace fs = std::filesystem;
namespace {

/// Compares a look with what is left of it.
class Lacking {
public:
    std::vector<std::string> words;

    void say(const std::string& what) {
        if (std::find(words.begin(), words.end(), what) == words.end()) words.push_back(what);
    }
    void lights(const Look& whole, const Look& left) {
        lost(whole.emitters, left.emitters);
        lost(whole.added, left.added);
        if (whole.parts.size() > left.parts.size()) say("an object that was moved");
    }

private:
    template <class Light>
    void lost(const std::vector<Light>& whole, const std::vector<Light>& left) {
        for (const Light& light : whole)
            if (std::none_of(left.begin(), left.end(), [&](const Light& other) { return other.id == light.id; }))
                say(light.name.empty() ? shownName(light.id) : light.name);
    }
};

/// A file of ours: some other program's may not be written over.
bool isLookFile(const fs::path& file) {
    try {
        const Json document = parseJson(readBytes(file, size_t(64) << 20));
        if (!document.is_object() || document.contains("look") || document.contains("frames")) return false;
        for (const char* key : {"environment", "emitters", "added_emitters", "keys", "value_keys"})
            if (document.contains(key)) return true;
    } catch (const Error&) {}
    return false;
}

}  // namespace

LookHere lookHere(const Look& look, const Estimate& estimate, size_t vertices) {
    LookHere here{lookThatFits(look, estimate, vertices), {}};
    Lacking lacking;
    lacking.lights(look, here.look);
    for (size_t i = 0; i < look.keys.size(); ++i) lacking.lights(look.keys[i].look, here.look.keys[i].look);
    const auto hasState = [&](const std::string& name) {
        return name.empty() || std::any_of(estimate.states.begin(), estimate.states.end(),
                                           [&](const auto& state) { return state.name == name; });
    };
    std::map<fs::path, bool> readable;
    const auto panorama = [&](const EnvironmentLook& wanted) {
        const auto known = readable.find(wanted.file);
        if (known != readable.end()) return known->second;
        bool& can = readable[wanted.file];
        try {
            distantOfLook(estimate, wanted);
            can = true;
        } catch (const Error& error) { logWarning("{}", error.what()); }
        return can;
    };
    eachLook(here.look, [&](Look& one) {
        EnvironmentLook& environment = one.environment;
        for (const std::string& state : {environment.state, environment.mixState})
            if (!hasState(state)) lacking.say("the lighting state " + state);
        if (!hasState(environment.state)) environment.state.clear();
        if (!hasState(environment.mixState)) environment.mixState.clear(), environment.mix = 0;
        if (environment.source == EnvironmentLook::Source::file && !panorama(environment)) {
            lacking.say("the environment " + environment.file.string());
            environment.source = EnvironmentLook::Source::recovered;
            environment.file.clear();
        }
        for (AddedEmitter& light : one.added)
            for (const ShapingFile which : shapingFiles)
                if (fs::path& file = light.shaping.*which; !file.empty() && !isThere(file))
                    lacking.say("the file " + file.string()), file.clear();
    });
    if (look.plate) lacking.say("its plate (Import plate, in the File menu)");
    here.look.plate.reset();
    here.look.bookmarks.clear();
    here.lacking = std::move(lacking.words);
    return here;
}

void saveLook(Editor& editor, const fs::path& file) {
    const auto& capture = editor.state.document.capture;
    if (!editor.estimate() || !capture) return;
    try {
        if (isThere(file) && !isLookFile(file)) throw Error("{}: is there and holds no look", file.string());
        Look look = editor.look();
        look.plate.reset();
        look.bookmarks.clear();
        writeBytesAtomically(file, dumpJson(lookToJson(look, capture->origin), 1) + "\n");
    } catch (const std::exception& error) {
        editor.fail("The look could not be saved", error.what(), "Choose another name or folder.");
        return;
    }
    remember(editor.state.recentLooks, file);
    editor.say("The look was saved as " + file.filename().string());
}

void loadLook(Editor& editor, const fs::path& file) {
    const auto estimate = editor.estimate();
    const auto& capture = editor.state.document.capture;
    const auto& scene = editor.state.document.scene;
    if (!estimate || !capture || !scene) return;
    const auto here = std::make_shared<LookHere>();
    if (!isThere(file)) std::erase(editor.state.recentLooks, file);
    editor.readInBackground(
        file,
        [=, origin = capture->origin, vertices = scene->mesh.vertexCount()] {
            *here = lookHere(readLook(file, origin), *estimate, vertices);
        },
        [here, file](Editor& e) {
            const std::string name = file.stem().string();
            const size_t before = e.history().index();
            e.edit("Look " + name, [&](Look& look) {
                Look loaded = here->look;
                loaded.plate = look.plate;
                loaded.bookmarks = look.bookmarks;
                look = std::move(loaded);
            });
            std::erase_if(e.state.selection.emitters, [&](const std::string& id) { return !e.emitter(id); });
            remember(e.state.recentLooks, file);
            if (e.history().index() == before) e.say("The present look is " + name + " already");
            if (here->lacking.empty()) return;
            constexpr size_t most = 8;
            std::string words;
            for (size_t i = 0; i < std::min(most, here->lacking.size()); ++i)
                words += (i ? ", " : "") + here->lacking[i];
            if (here->lacking.size() > most) words += fmt::format(" and {} more", here->lacking.size() - most);
            e.fail("Not all of this look is in this shot", "The look names, and the shot lacks: " + words + ".",
                   "Everything else of it was loaded. Ctrl+Z takes it back.");
        });
}

}  // namespace relamp::ui
