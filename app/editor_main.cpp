// relamp-editor, the window.
#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "application.h"
#include "base/error.h"

int main(int argc, char** argv) {
    // Where libglvnd patches entry points, some drivers refuse the second context that light is summed in.
    setenv("__GLVND_DISALLOW_PATCHING", "1", 0);
    CLI::App app{"relamp-editor: the window of relamp, to relight a captured scene by hand."};
    app.set_version_flag("--version", "relamp-editor " RELAMP_VERSION);
    relamp::ui::ApplicationOptions options;
    app.add_option("path", options.open, "Capture folder or saved shot to open");
    app.add_flag("--solve", options.solve, "Estimate as soon as it is open");
    app.add_option("--quality", options.quality, "Of estimates (standard)")
        ->check(CLI::IsMember({"draft", "standard", "fine"}));
    app.add_option("--scale", options.scale, "Size of everything in the window, 0.75 to 3 (as the monitor says)")
        ->check(CLI::Range(0.75, 3.0));
    app.add_option("--width", options.width, "Of the window, pixels")->check(CLI::Range(640, 16384));
    app.add_option("--height", options.height, "Of the window, pixels")->check(CLI::Range(400, 16384));
    app.add_option("--gpu", options.gpu,
                   "Where light is computed: auto (the faster of processor and graphics card), on (graphics card), off "
                   "(processor)")
        ->check(CLI::IsMember({"auto", "on", "off"}));
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) { return app.exit(error) ? 2 : 0; }
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow further is a failed write, not an end
    try {
        return relamp::ui::runApplication(options);
    } catch (const relamp::Error& error) {
        std::fprintf(stderr, "relamp-editor: %s\n", error.what());
        return 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "relamp-editor: %s\n", error.what());
        return 1;
    }
}
