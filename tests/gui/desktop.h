// A real desktop for the real program: Xvfb, relamp-editor, xdotool for mouse and keys, screenshots. What the program
// shows and does is read from the map it writes when RELAMP_ITEM_MAP is set.
#pragma once
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "image/image_io.h"
#include "support/temporary_folder.h"

namespace relamp::test {

class Desktop {
public:
    /// `environment` = further NAME=VALUE settings for the program.
    Desktop(int width, int height, std::vector<std::string> environment = {}) : environment_(std::move(environment)) {
        int ends[2];
        if (pipe(ends) != 0) throw std::runtime_error("no pipe");
        const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
        xvfb_ = fork();
        if (xvfb_ == 0) {
            dup2(ends[1], 3);
            if (!std::freopen("/dev/null", "w", stderr)) _exit(127);
            execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", screen.c_str(), "-nolisten", "tcp", "-noreset",
                   static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        char c;
        while (read(ends[0], &c, 1) == 1 && c != '\n') display_ += c;
        close(ends[0]);
        if (display_.empty()) throw std::runtime_error("Xvfb did not start: is it installed?");
    }
    ~Desktop() {
        end(SIGKILL);
        if (xvfb_ > 0) {
            kill(xvfb_, SIGTERM);
            waitpid(xvfb_, nullptr, 0);
        }
    }
    Desktop(const Desktop&) = delete;
    Desktop& operator=(const Desktop&) = delete;

    const TemporaryFolder& home() const { return home_; }

    /// Starts the editor on the whole screen.
    void start(const std::vector<std::string>& arguments) {
        std::filesystem::remove(home_ / "map.json");
        editor_ = fork();
        if (editor_ != 0) return;
        setenv("DISPLAY", (":" + display_).c_str(), 1);
        setenv("HOME", home_.path().c_str(), 1);
        setenv("XDG_CONFIG_HOME", (home_ / "config").c_str(), 1);
        setenv("XDG_STATE_HOME", (home_ / "state").c_str(), 1);
        setenv("RELAMP_ITEM_MAP", (home_ / "map.json").c_str(), 1);
        setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
        for (const std::string& setting : environment_) putenv(const_cast<char*>(setting.c_str()));
        if (!std::freopen((home_ / "log.txt").c_str(), "a", stderr)) _exit(127);
        std::vector<char*> words{const_cast<char*>(RELAMP_EDITOR)};
        for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
        words.push_back(nullptr);
        execv(RELAMP_EDITOR, words.data());
        _exit(127);
    }
    /// Kills or asks the editor to end; its exit status, -1 when a signal ended it.
    int end(int signalNumber) {
        if (editor_ <= 0) return -1;
        kill(editor_, signalNumber);
        return ended();
    }
    /// Waits for the editor to end by itself.
    int ended() {
        int status = 0;
        for (int i = 0; i < 600; ++i) {
            if (waitpid(editor_, &status, WNOHANG) == editor_) {
                editor_ = 0;
                return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        kill(editor_, SIGKILL);
        waitpid(editor_, &status, 0);
        editor_ = 0;
        return -2;
    }
    pid_t editor() const { return editor_; }

    /// The program's map of its latest frame.
    nlohmann::json map() const {
        const nlohmann::json document =
            nlohmann::json::parse(TemporaryFolder::read(home_ / "map.json"), nullptr, false);
        return document.is_object() ? document : nlohmann::json{{"items", nlohmann::json::object()}, {"frame", 0}};
    }
    /// Looks at the map until `done`; false after `seconds`, ten times as many under a sanitizer.
    bool until(const std::function<bool(const nlohmann::json&)>& done, double seconds = 60) const {
#ifdef RELAMP_SANITIZED
        seconds *= 10;
#endif
        const auto start = std::chrono::steady_clock::now();
        while (std::chrono::steady_clock::now() - start < std::chrono::duration<double>(seconds)) {
            const nlohmann::json now = map();
            if (now.contains("job") && done(now)) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(30));
        }
        return false;
    }
    bool untilItem(const std::string& name, double seconds = 20) const {
        return until([&](const nlohmann::json& m) { return m["items"].contains(name); }, seconds);
    }
    /// Nothing runs and the image is refined.
    bool settled(double seconds = 90) const {
        return until(
            [](const nlohmann::json& m) { return m["job"] == "" && m["refined"] == true && m["busy"] == false; },
            seconds);
    }
    std::pair<int, int> middleOf(const std::string& name) const {
        const nlohmann::json item = map()["items"].value(name, nlohmann::json{});
        if (!item.is_array()) throw std::runtime_error("the window shows no " + name);
        return {int((item[0].get<double>() + item[2].get<double>()) / 2),
                int((item[1].get<double>() + item[3].get<double>()) / 2)};
    }

    // ---- mouse and keys
    void xdotool(const std::string& words) const {
        const std::string command = "DISPLAY=:" + display_ + " xdotool " + words + " >/dev/null 2>&1";
        if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
    }
    void moveTo(int x, int y) const { xdotool("mousemove " + std::to_string(x) + " " + std::to_string(y)); }
    void click(int x, int y, int button = 1) const {
        moveTo(x, y);
        pause();
        xdotool("mousedown " + std::to_string(button));
        pause();
        xdotool("mouseup " + std::to_string(button));
        pause();
    }
    void click(const std::string& item) const {
        if (!untilItem(item)) throw std::runtime_error("the window shows no " + item);
        const auto [x, y] = middleOf(item);
        click(x, y);
    }
    /// In `steps` moves with the button down.
    void drag(int x0, int y0, int x1, int y1, int button = 1, int steps = 10) const {
        moveTo(x0, y0);
        pause();
        xdotool("mousedown " + std::to_string(button));
        pause();
        for (int i = 1; i <= steps; ++i) {
            moveTo(x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps);
            std::this_thread::sleep_for(std::chrono::milliseconds(40));
        }
        pause();
        xdotool("mouseup " + std::to_string(button));
        pause();
    }
    void key(const std::string& chord) const {
        xdotool("key " + chord);
        pause();
    }
    /// `delay`: milliseconds between two characters.
    void type(const std::string& text, int delay = 30) const {
        xdotool("type --delay " + std::to_string(delay) + " '" + text + "'");
        pause();
    }
    /// A moment, and two frames of the window: a slow machine gets the time it needs.
    void pause() const {
        std::this_thread::sleep_for(std::chrono::milliseconds(120));
        const int frame = map()["frame"];
        for (int i = 0; i < 20 && map()["frame"] < frame + 2; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }

    Image screenshot(const std::string& name) const {
        const std::filesystem::path file = home_ / (name + ".png");
        const std::string command = "DISPLAY=:" + display_ +
                                    " import -window root -define png:compression-level=1 png24:" + file.string() +
                                    " 2>/dev/null";
        if (std::system(command.c_str()) != 0) throw std::runtime_error("no screenshot: is ImageMagick installed?");
        if (const char* keep = std::getenv("RELAMP_KEEP_SCREENSHOTS")) {
            std::error_code ignored;
            std::filesystem::copy_file(file, std::filesystem::path(keep) / (name + ".png"),
                                       std::filesystem::copy_options::overwrite_existing, ignored);
        }
        return readImage(file);
    }

private:
    TemporaryFolder home_;
    std::vector<std::string> environment_;
    std::string display_;
    pid_t xvfb_ = 0, editor_ = 0;
};

/// What the window says of itself, for a failed test.
inline std::string state(const Desktop& desk) {
    nlohmann::json map = desk.map();
    map.erase("items");
    return map.dump();
}

struct Box {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
/// The image without the toolbar.
inline Box imageOf(const Desktop& desk) {
    const nlohmann::json item = desk.map()["items"].at("viewport");
    return {item[0].get<int>() + 2, item[1].get<int>() + 2, item[2].get<int>() - 2, item[3].get<int>() - 2};
}

/// Only rounding differs: one of them went through a saved shot.
inline void expectSameFrame(const std::filesystem::path& one, const std::filesystem::path& other) {
    const Image a = readImage(one), b = readImage(other);
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    double sum = 0, error = 0;
    for (size_t i = 0; i < b.pixels.size(); ++i) {
        sum += double(luminance(b.pixels[i]));
        error += double(std::abs(luminance(b.pixels[i]) - luminance(a.pixels[i])));
    }
    EXPECT_LT(error, 0.005 * sum);
}

/// Root mean square difference inside a rectangle (pixels), of values in [0, 1] linear.
inline double differenceIn(const Image& a, const Image& b, int x0, int y0, int x1, int y1) {
    double sum = 0, count = 0;
    for (int y = std::max(0, y0); y < std::min({y1, a.height, b.height}); ++y)
        for (int x = std::max(0, x0); x < std::min({x1, a.width, b.width}); ++x) {
            const Rgb d = a.at(x, y) - b.at(x, y);
            sum += double(glm::dot(d, d)) / 3;
            ++count;
        }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace relamp::test
