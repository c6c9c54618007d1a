// Loaded before a program (LD_PRELOAD), this stops it at the door of main and lets each run be a copy of that process:
// the dynamic loader's work on several hundred libraries is done once for many runs. A run has the program's own
// constructors and main, its own folder and outputs. Without RELAMP_WARM_SOCKET nothing is changed.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using Main = int (*)(int, char**, char**);
using Hook = void (*)();
using Start = int (*)(Main, int, char**, Hook, Hook, Hook, void*);

bool readAll(int from, void* to, size_t size) {
    for (size_t done = 0; done < size;) {
        const ssize_t n = read(from, static_cast<char*>(to) + done, size - done);
        if (n <= 0) return false;
        done += size_t(n);
    }
    return true;
}

/// From a run's words, "output\0error\0folder\0argument\0...": the arguments, and after them the environment.
char** prepared(char* words, size_t size, int& count) {
    size_t settings = 0;
    while (environ[settings]) ++settings;
    char** argv = static_cast<char**>(std::calloc(size + settings + 2, sizeof(char*)));
    if (!argv) _exit(127);
    count = 0;
    for (size_t at = 0; at < size; at += std::strlen(words + at) + 1) argv[count++] = words + at;
    std::memcpy(argv + count + 1, environ, settings * sizeof(char*));
    const int out = open(argv[0], O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int error = open(argv[1], O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (out < 0 || error < 0 || chdir(argv[2]) != 0) _exit(127);
    dup2(out, 1);
    dup2(error, 2);
    close(out);
    close(error);
    count -= 3;
    return argv + 3;
}

/// Comes back in every run's process, and never in the first one.
char** nextRun(int line, int& count) {
    for (;;) {
        uint32_t size;
        if (!readAll(line, &size, sizeof size)) _exit(0);  // the test has ended
        char* words = static_cast<char*>(std::malloc(size));
        if (!words || !readAll(line, words, size)) _exit(127);
        const pid_t run = fork();
        if (run == 0) {
            close(line);
            return prepared(words, size, count);
        }
        std::free(words);
        int status = 0;
        if (write(line, &run, sizeof run) != sizeof run) _exit(127);
        if (waitpid(run, &status, 0) != run || write(line, &status, sizeof status) != sizeof status) _exit(127);
    }
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int __libc_start_main(Main program, int argc, char** argv, Hook init,
                                                                        Hook fini, Hook loader, void* stack) {
    const auto start = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
    if (const char* socket = std::getenv("RELAMP_WARM_SOCKET")) {
        const int line = std::atoi(socket);
        unsetenv("RELAMP_WARM_SOCKET");
        unsetenv("LD_PRELOAD");
        argv = nextRun(line, argc);
        // The libraries' own ends are left out: they may wait for threads of the first process (log4cplus does).
        loader = nullptr;
        on_exit(
            [](int status, void*) {
                std::fflush(nullptr);
                _exit(status);
            },
            nullptr);
    }
    return start(program, argc, argv, init, fini, loader, stack);
}
