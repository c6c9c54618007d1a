// relamp solve --list: the captures of a list, one after the other, each as a solve of its own.
#include <map>
#include <set>
#include <thread>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/log.h"
#include "base/printable.h"
#include "commands.h"
#include "shot/frame_jobs.h"

namespace relamp::cli {
namespace {

constexpr size_t maxListBytes = size_t(16) << 20;

struct Listed {
    size_t line = 0;
    fs::path capture, shot;
};

std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// A line is a capture, relative to the list's folder, or a capture, a tab and the shot's name. Empty lines and those
/// that begin with # do not count.
std::vector<Listed> readList(const fs::path& file, const fs::path& output) {
    const std::string text = readBytes(file, maxListBytes);
    const fs::path folder = fs::absolute(file).parent_path();
    std::vector<Listed> items;
    std::map<fs::path, size_t> lineOf;
    size_t line = 0;
    for (size_t at = 0; at < text.size(); ++line) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const std::string words = text.substr(at, end - at);
        at = end + 1;
        const size_t tab = words.find('\t', std::min(words.find_first_not_of(" \t"), words.size()));
        const std::string capture = trimmed(words.substr(0, tab));
        if (capture.empty() || capture[0] == '#') continue;
        const std::string where = fmt::format("{}: line {}", file.string(), line + 1);
        if (capture.find('\0') != std::string::npos) throw Error("{}: is no path", where);
        Listed item{line + 1, (folder / capture).lexically_normal(), {}};
        if (!item.capture.has_filename()) item.capture = item.capture.parent_path();
        std::string name = tab == std::string::npos ? item.capture.filename().string() : trimmed(words.substr(tab));
        if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
            throw Error("{}: a shot's name is expected after the tab, without /", where);
        if (!name.ends_with(".relamp")) name += ".relamp";
        item.shot = output / name;
        const auto [known, isNew] = lineOf.emplace(item.shot, line + 1);
        if (!isNew)
            throw Error("{}: {} is the shot of line {} already; give one of them a name after a tab", where, name,
                        known->second);
        items.push_back(std::move(item));
    }
    if (items.empty()) throw Error("{}: names no capture", file.string());
    return items;
}

/// Those that `--items` names, counted from 1; numbers past the end are skipped with a notice.
std::vector<Listed> selected(std::vector<Listed> items, const std::string& numbers) {
    if (numbers.empty()) return items;
    std::vector<Listed> chosen;
    std::vector<int> wanted;
    try {
        wanted = parseFrameRange(numbers, "--items");
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    size_t outside = 0;
    for (const int n : wanted)
        if (n >= 1 && size_t(n) <= items.size()) chosen.push_back(items[size_t(n) - 1]);
        else ++outside;
    if (outside)
        logInfo("--items {}: {} of them outside the list of {}", numbers, outside, counted(items.size(), "capture"));
    return chosen;
}

/// Solves one under a clock and a budget of its own, as `solve` alone would. Stops when `all` is stopped.
int solveOne(const SolveArguments& arguments, const std::string& name, Progress& all) {
    Progress own;
    constexpr size_t steps = 1000;
    std::string stage;
    size_t told = 0;
    own.setListener([&](const std::string& label, double fraction) {
        if (all.stopRequested()) return;
        if (label != stage) {
            stage = label;
            told = 0;
            all.begin(name + ": " + label, steps);
        }
        const size_t now = std::min(steps, size_t(fraction * double(steps)));
        if (now > told) all.advance(now - told);
        told = std::max(told, now);
    });
    const std::jthread stops([&](const std::stop_token& done) {
        while (!done.stop_requested()) {
            if (all.stopRequested()) own.requestStop();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    });
    return solve(arguments, own);
}

}  // namespace

int solveList(const SolveArguments& a, Progress& progress) {
    const std::vector<Listed> items = selected(readList(a.list, a.output), a.items);
    std::error_code failed;
    fs::create_directories(a.output, failed);
    if (failed) throw Error("{}: cannot be made ({})", a.output.string(), failed.message());
    size_t solved = 0, skipped = 0, failures = 0, poor = 0;
    std::optional<Error> first;
    for (const Listed& item : items) {
        progress.check();
        if (a.skipExisting && isThere(item.shot / "shot.json")) {
            logInfo("{}: exists, skipped", item.shot.string());
            ++skipped;
            continue;
        }
        SolveArguments one = a;
        one.list.clear();
        one.items.clear();
        one.skipExisting = false;
        one.capture = item.capture;
        one.output = item.shot;
        try {
            poor += solveOne(one, item.shot.stem().string(), progress) == 4;
            ++solved;
            logInfo("{}: written ({} of {})", item.shot.string(), solved + skipped, items.size());
        } catch (const UsageError&) {
            throw;  // the same for all of them
        } catch (const OutOfResources&) {
            throw;  // the others would not fit either; --skip-existing goes on from here
        } catch (const Error& error) {
            const Error named("line {}: {}", item.line, error.what());
            logWarning("{}", named.what());
            if (!first) first = named;
            ++failures;
        }
    }
    if (first && !solved && !skipped) throw *first;
    return failures ? 5 : poor ? 4 : 0;
}

}  // namespace relamp::cli
