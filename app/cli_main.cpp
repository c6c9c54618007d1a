// relamp, the command line. Links no window and no GL. stdout carries the result only, stderr log and progress.
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>

#include "base/json_fields.h"
#include "base/log.h"
#include "command_line.h"
#include "plan_command.h"

namespace {

relamp::Progress* currentProgress = nullptr;
std::atomic<int> caughtSignal{0};

extern "C" void onSignal(int number) {
    caughtSignal = number;
    if (currentProgress) currentProgress->requestStop();
}

/// --progress auto|bar|json|none.
void showProgress(relamp::Progress& progress, std::string mode) {
    if (mode == "auto") mode = isatty(2) ? "bar" : "none";
    if (mode == "bar")
        progress.setListener([](const std::string& label, double fraction) {
            std::fprintf(stderr, "\r\033[K%s %3.0f %%", label.c_str(), fraction * 100);
        });
    else if (mode == "json")
        progress.setListener([](const std::string& label, double fraction) {
            const nlohmann::json step{{"stage", label}, {"fraction", fraction}, {"share", fraction}};
            std::fprintf(stderr, "%s\n", relamp::dumpJson(step).c_str());
        });
}

int run(const relamp::cli::CommandLine& line, relamp::Progress& progress) {
    using namespace relamp;
    switch (line.verb) {
        case cli::Verb::edit: return cli::edit(line.editPath);
        case cli::Verb::check: return cli::check(line.path, line.fix, line.json, progress);
        case cli::Verb::plan: return cli::plan(line.solve, line.json, progress);
        case cli::Verb::solve: return cli::solve(line.solve, progress);
        case cli::Verb::render: return cli::render(line.render, progress);
        case cli::Verb::exportShot: return cli::exportShot(line.exported, progress);
        case cli::Verb::compare: return cli::compare(line.compare, progress);
        case cli::Verb::mergeHdr: return cli::mergeHdr(line.merge, progress);
        case cli::Verb::report: return cli::report(line.report, progress);
        case cli::Verb::stress: return cli::stress(line.stress, progress);
        case cli::Verb::info: return cli::info(line.path, line.fix, line.json, progress);
    }
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace relamp;
    int ended = 0;
    const std::optional<cli::CommandLine> line = cli::parseCommandLine(argc, argv, ended);
    if (!line) return ended;

    Progress progress;
    currentProgress = &progress;
    struct sigaction action {};
    action.sa_handler = onSignal;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    signal(SIGXFSZ, SIG_IGN);  // a file that may not grow further is a failed write, not an end
    const bool bar = line->progressMode == "bar" || (line->progressMode == "auto" && isatty(2));
    if (!line->quiet)
        setLogSink([bar](LogLevel level, const std::string& text) {
            std::fprintf(stderr, "%s%s%s\n", bar ? "\r\033[K" : "", level == LogLevel::warning ? "warning: " : "",
                         text.c_str());
        });
    showProgress(progress, line->progressMode);

    const auto fail = [&](int code, const char* what) {
        std::fprintf(stderr, "%srelamp: %s\n", bar ? "\r\033[K" : "", what);
        return code;
    };
    try {
        const int code = run(*line, progress);
        if (bar) std::fputs("\r\033[K", stderr);
        return code;
    } catch (const Cancelled&) {
        return fail(128 + (caughtSignal ? caughtSignal.load() : SIGINT), "stopped");
    } catch (const cli::UsageError& error) { return fail(2, error.what()); } catch (const OutOfResources& error) {
        return fail(6, error.what());
    } catch (const Error& error) { return fail(3, error.what()); } catch (const std::bad_alloc&) {
        return fail(6, "out of memory");
    } catch (const std::exception& error) { return fail(1, error.what()); }
}
