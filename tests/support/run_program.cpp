#include "support/run_program.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace relamp::test {
namespace {

/// relamp before its main, see preload/warm_start.cpp: most of a short run is the dynamic loader's.
class WarmProgram {
public:
    explicit WarmProgram(const std::string& program) : program_(program), environment_(environmentNow()) {
        int ends[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) throw std::runtime_error("no socket");
        line_ = ends[0];
        ::fcntl(line_, F_SETFD, FD_CLOEXEC);
        process_ = ::fork();
        if (process_ == 0) {
            ::dup2(::open("/dev/null", O_RDONLY), 0);
            ::setenv("RELAMP_WARM_SOCKET", std::to_string(ends[1]).c_str(), 1);
            ::setenv("LD_PRELOAD", RELAMP_WARM_START, 1);
            ::execl(program.c_str(), program.c_str(), static_cast<char*>(nullptr));
            ::_exit(127);
        }
        ::close(ends[1]);
    }
    ~WarmProgram() {
        ::close(line_);
        ::waitpid(process_, nullptr, 0);
    }
    WarmProgram(const WarmProgram&) = delete;
    WarmProgram& operator=(const WarmProgram&) = delete;

    /// A process keeps the environment that it was started with.
    bool serves(const std::string& program) const { return program == program_ && environmentNow() == environment_; }

    pid_t start(const std::vector<std::string>& arguments, const std::string& out, const std::string& error) {
        std::string words;
        for (const std::string& word : {out, error, std::filesystem::current_path().string()}) words += word + '\0';
        for (const std::string& word : arguments) words += word + '\0';
        const auto size = uint32_t(words.size());
        words.insert(0, reinterpret_cast<const char*>(&size), sizeof size);
        if (::write(line_, words.data(), words.size()) != ssize_t(words.size())) throw std::runtime_error("no run");
        return received();
    }
    /// As waitpid; without `wait` false while it runs.
    bool ended(bool wait, int& status) {
        char c;
        if (!wait && ::recv(line_, &c, 1, MSG_PEEK | MSG_DONTWAIT) < 0) return false;
        status = received();
        return true;
    }

private:
    static std::vector<std::string> environmentNow() {
        std::vector<std::string> all;
        for (char** setting = environ; *setting; ++setting) all.emplace_back(*setting);
        return all;
    }
    int received() const {
        int value = 0;
        if (::recv(line_, &value, sizeof value, MSG_WAITALL) != sizeof value)
            throw std::runtime_error("the warm program has ended");
        return value;
    }
    const std::string program_;
    const std::vector<std::string> environment_;
    int line_ = -1;
    pid_t process_ = 0;
};

/// None where every start must be the loader's own: for other programs, and under a sanitizer.
WarmProgram* warmFor(const std::string& program) {
#ifndef RELAMP_SANITIZED
    static std::unique_ptr<WarmProgram> warm;
    if (program == RELAMP_BINARY) {
        if (!warm || !warm->serves(program)) warm = std::make_unique<WarmProgram>(program);
        return warm.get();
    }
#endif
    (void)program;
    return nullptr;
}

pid_t startCold(const std::vector<std::string>& arguments, const std::string& out, const std::string& error) {
    std::vector<char*> argv;
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(::open("/dev/null", O_RDONLY), 0);
        ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 1);
        ::dup2(::open(error.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    return child;
}

}  // namespace

ProgramResult runProgram(const std::vector<std::string>& arguments, const std::string& interruptOn, int signalNumber) {
    const TemporaryFolder folder;
    const std::filesystem::path out = folder / "out", error = folder / "error";
    // It serves one run at a time.
    static std::mutex oneRun;
    const std::unique_lock<std::mutex> mine(oneRun, std::try_to_lock);
    WarmProgram* warm = mine ? warmFor(arguments[0]) : nullptr;
    const pid_t child = warm ? warm->start(arguments, out, error) : startCold(arguments, out, error);
    int status = 0;
    bool outgoing = false;
    for (int step = 0;; ++step) {
        const bool wait = interruptOn.empty();
        if (warm ? warm->ended(wait, status) : ::waitpid(child, &status, wait ? 0 : WNOHANG) == child) break;
        if (!outgoing && TemporaryFolder::read(error).find(interruptOn) != std::string::npos) {
            ::kill(child, signalNumber);
            outgoing = true;
        }
        if (step > 60000) ::kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ProgramResult result;
    result.exitCode = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    result.out = TemporaryFolder::read(out);
    result.error = TemporaryFolder::read(error);
    return result;
}

}  // namespace relamp::test
