// relamp export: the scene for other programs.
#include "base/log.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "capture/own_axes.h"
#include "commands.h"
#include "relight/state_look.h"
#include "render_frames.h"
#include "shot/export_scene.h"

namespace relamp::cli {

int exportShot(const ExportArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    const Shot shot = openShot(a.shot, false, progress);
    Look look = a.edits.empty() ? shot.look : readLook(a.edits, shot.capture.origin);
    if (const auto state = stateOf(a.state, shot)) look = inState(std::move(look), shot.estimate, *state);
    InputFiles inputs = shotFiles(shot, progress);
    inputs.add(a.edits);
    for (const auto& file : filesOf(look)) inputs.add(file);
    const Scene scene = buildScene(shot.capture.mesh, progress, ownAxes(shot.capture));
    const RelitScene relit = applyLook(scene, shot.estimate, look, progress);
    progress.check();
    for (const std::string& line : exportScene(shot, relit, a.output, a.overwrite, inputs)) logInfo("{}", line);
    logInfo("{}: {}, environment, materials and {} written", a.output.string(), counted(relit.emitters.size(), "light"),
            counted(shot.capture.views.size(), "camera"));
    return 0;
}

}  // namespace relamp::cli
