#include "fuzz/target.h"

#include <stdlib.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>

#include "base/error.h"

namespace relamp::fuzz {
namespace {
namespace fs = std::filesystem;

std::map<std::string, Run>& registered() {
    static std::map<std::string, Run> all;
    return all;
}

struct OwnFolder {
    fs::path path;
    OwnFolder() {
        std::string name =
            (access("/dev/shm", W_OK) == 0 ? fs::path("/dev/shm") : fs::temp_directory_path()) / "relamp-fuzz-XXXXXX";
        if (!mkdtemp(name.data())) throw std::runtime_error("no folder can be made");
        path = name;
    }
    ~OwnFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

}  // namespace

Target::Target(const char* name, Run run) { registered()[name] = run; }

const std::map<std::string, Run>& targets() { return registered(); }

bool runTarget(const std::string& target, std::string_view bytes) {
    const Run run = registered().at(target);
    try {
        run(bytes);
        return true;
    } catch (const Error&) { return false; }
}

const fs::path& folder() {
    static const OwnFolder own;
    return own.path;
}

fs::path fileWith(const std::string& name, std::string_view bytes) {
    const fs::path file = folder() / name;
    if (file.parent_path() != folder()) fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
    return file;
}

std::string_view part(std::string_view bytes, size_t index) {
    constexpr std::string_view border = "\n=====\n";
    for (; index > 0; --index) {
        const size_t at = bytes.find(border);
        if (at == std::string_view::npos) return {};
        bytes.remove_prefix(at + border.size());
    }
    return bytes.substr(0, bytes.find(border));
}

}  // namespace relamp::fuzz
