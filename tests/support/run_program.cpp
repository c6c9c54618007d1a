#include "support/run_program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

namespace relamp::test {

ProgramResult runProgram(const std::vector<std::string>& arguments, const std::string& interruptOn, int signalNumber) {
    const TemporaryFolder folder;
    const std::filesystem::path out = folder / "out", error = folder / "error";
    std::vector<char*> argv;
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    const std::string outName = out.string(), errorName = error.string();
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(::open("/dev/null", O_RDONLY), 0);
        ::dup2(::open(outName.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 1);
        ::dup2(::open(errorName.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
        ::execv(argv[0], argv.data());
        ::_exit(127);
    }
    int status = 0;
    bool outgoing = false;
    for (int step = 0;; ++step) {
        const pid_t done = ::waitpid(child, &status, interruptOn.empty() ? 0 : WNOHANG);
        if (done == child) break;
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
