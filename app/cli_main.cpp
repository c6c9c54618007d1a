// relamp, the command line. Links no window and no GL. stdout carries the result only, stderr log and progress.
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/json_fields.h"
#include "base/log.h"
#include "base/printable.h"
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

/// What of the machine's means is at its end, by what the libraries throw then; null for other errors.
const char* lackOf(const std::exception& error) {
    if (dynamic_cast<const std::bad_alloc*>(&error)) return "out of memory";
    const auto* system = dynamic_cast<const std::system_error*>(&error);
    const bool noThread = (system && system->code() == std::errc::resource_unavailable_try_again) ||
                          std::strncmp(error.what(), "pthread_create", 14) == 0;
    if (noThread) return "no thread can be started: memory, or the number of processes, is at its limit";
    return system && system->code() == std::errc::not_enough_memory ? "out of memory" : nullptr;
}

/// Without memory there may be none for a message either, so it is written as it stands.
[[noreturn]] void endFor(const char* lack) {
    for (const char* part : {"relamp: ", lack, "\n"})
        if (::write(2, part, std::strlen(part)) < 0) break;
    ::_exit(6);
}

/// For what is thrown where nothing can catch it, such as in a library's own thread: the exit code is right all the
/// same.
[[noreturn]] void endAtOnce() {
    const char* lack = nullptr;
    try {
        if (std::current_exception()) std::rethrow_exception(std::current_exception());
    } catch (const std::exception& error) { lack = lackOf(error); } catch (...) {
    }
    if (!lack) std::abort();
    endFor(lack);
}

/// Before the libraries begin: they start threads and fill tables before main does, and without memory crash there.
extern "C" void beforeLibraries(int, char**, char**) {
    std::set_terminate(endAtOnce);
    constexpr size_t least = size_t(128) << 20;  // less than any verb needs
    void* const space = ::mmap(nullptr, least, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (space == MAP_FAILED) endFor("out of memory");
    ::munmap(space, least);
}
[[gnu::used, gnu::section(".preinit_array")]] void (*const runBeforeLibraries)(int, char**, char**) = beforeLibraries;

int run(const relamp::cli::CommandLine& line, relamp::Progress& progress) {
    using namespace relamp;
    switch (line.verb) {
        case cli::Verb::edit: return cli::edit(line.editPath);
        case cli::Verb::check: return cli::check(line.path, line.fix, line.json, progress);
        case cli::Verb::plan: return cli::plan(line.solve, line.json, progress);
        case cli::Verb::solve:
            return line.solve.list.empty() ? cli::solve(line.solve, progress) : cli::solveList(line.solve, progress);
        case cli::Verb::render: return cli::render(line.render, progress);
        case cli::Verb::exportShot: return cli::exportShot(line.exported, progress);
        case cli::Verb::paint: return cli::paint(line.paint, progress);
        case cli::Verb::compare: return cli::compare(line.compare, progress);
        case cli::Verb::mergeHdr: return cli::mergeHdr(line.merge, progress);
        case cli::Verb::report: return cli::report(line.report, progress);
        case cli::Verb::scan: return cli::scan(line.scan, progress);
        case cli::Verb::stress: return cli::stress(line.stress, progress);
        case cli::Verb::info: return cli::info(line.path, line.fix, line.json, progress);
    }
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace relamp;
    int ended = 0;
    std::optional<cli::CommandLine> line;
    try {
        line = cli::parseCommandLine(argc, argv, ended);
    } catch (const Error& error) {  // help or version could not be printed
        std::fprintf(stderr, "relamp: %s\n", error.what());
        return dynamic_cast<const OutOfResources*>(&error) ? 6 : 3;
    }
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
                         printable(text).c_str());
        });
    showProgress(progress, line->progressMode);

    const auto fail = [&](int code, const char* what) {
        std::fprintf(stderr, "%srelamp: %s\n", bar ? "\r\033[K" : "", printable(what).c_str());
        // Without means, what the libraries do at the end of a process may fail as well, and change the code.
        if (code == 6) ::_exit(code);
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
    } catch (const Error& error) { return fail(3, error.what()); } catch (const std::exception& error) {
        if (const char* lack = lackOf(error)) return fail(6, lack);
        return fail(1, error.what());
    }
}
